"""March."""
