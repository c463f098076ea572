"""Checks of codes, and how they compare with the time histories."""
