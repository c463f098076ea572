"""The motions that a set of records gives, the earthquakes that they belong to, and the one way through all of them."""
