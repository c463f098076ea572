"""The report: what a results file says, as one HTML page to hand over."""
