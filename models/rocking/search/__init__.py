"""Search for the scale factors on an input at which a body overturns."""
