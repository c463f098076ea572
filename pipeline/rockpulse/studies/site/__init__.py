"""The design spectrum or design sequence of a site, derived from its records."""
