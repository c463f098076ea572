"""Assessment: the response of every body to every record with every model, and the verdicts."""
