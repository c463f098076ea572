"""Selection of records whose mean spectrum fits a target spectrum."""
