"""Responses to a record: kernels that integrate the motion of many bodies together, and functions that call them."""
