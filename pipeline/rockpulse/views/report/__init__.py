"""The report of a results file, as one HTML page or PDF."""
