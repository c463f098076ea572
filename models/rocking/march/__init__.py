"""Responses to a record: kernels that integrate many lanes side by side in time, and the functions that call them."""
