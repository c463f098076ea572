"""The rule from half-waves to overturning, fitted on an ensemble of records and judged on it."""
