"""Selection of records whose mean spectrum matches a target spectrum."""
