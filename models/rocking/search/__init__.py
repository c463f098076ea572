"""Factors on an input at which a body overturns."""
