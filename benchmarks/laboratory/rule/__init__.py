"""The rule from half-waves to overturning, fitted to an ensemble of records and tested on it."""
