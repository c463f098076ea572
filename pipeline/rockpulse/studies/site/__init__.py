"""The design spectrum or design sequence of a site, from its records."""
