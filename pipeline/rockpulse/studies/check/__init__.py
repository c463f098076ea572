"""Checks of codes beside the time histories."""
