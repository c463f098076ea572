"""From records to impulse sequences: by statistics of half-waves, by the response, by a fitted rule, for a site."""
