"""How often bodies overturn at a site: fragility and hazard together."""
