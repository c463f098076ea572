"""Probabilities of overturning: by one spectrum of a record for all slender bodies, or by marches of each body."""
