"""What changed between two results files."""
