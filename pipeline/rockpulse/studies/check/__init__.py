"""Checks of bodies according to design codes, and their comparison with results of records."""
