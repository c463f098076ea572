"""Annual frequency at which bodies overturn at a site, from fragility and hazard."""
