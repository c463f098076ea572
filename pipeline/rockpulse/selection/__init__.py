"""Selects the records and directions to assess, groups records by earthquake, and finds duplicates."""
