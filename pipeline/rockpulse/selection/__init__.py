"""Selects the motions of a set of records, groups them by earthquake, and finds duplicates."""
