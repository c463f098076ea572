"""Impulse sequences of records, from their half-waves or from the responses of blocks."""
