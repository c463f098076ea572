"""Records, bodies and models put together: what every model answers for every body under every record."""
