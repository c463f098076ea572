"""Assessment: the response of every body to every record in every model, and the verdicts."""
