"""Assessment: the response of every body to every record by every model, and the verdicts."""
