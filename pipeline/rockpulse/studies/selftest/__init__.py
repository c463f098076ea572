"""Stored cases that an installation is tried on, and the solver that a user would write beside them."""
