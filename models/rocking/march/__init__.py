"""Responses to a record: kernels that march many lanes side by side, and their calls."""
