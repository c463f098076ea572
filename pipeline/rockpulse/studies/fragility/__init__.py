"""Fragility: the probability of a limit state given an intensity measure of the ground motion."""
