"""Probabilities of overturning, from one spectrum of a record for all slender bodies or from marches of each body."""
