"""The motions that a set of records gives, the earthquakes that they belong to, and those of the same shaking."""
