"""Checks of bodies by design codes, and their comparison with time histories."""
