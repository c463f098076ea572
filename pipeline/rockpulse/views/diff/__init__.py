"""The changes between two results files."""
