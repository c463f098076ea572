"""The design sequence of a site, from the sequences of its records."""
