"""Probabilities of overturning, from one spectrum of a record for all slender bodies or from responses of each body."""
