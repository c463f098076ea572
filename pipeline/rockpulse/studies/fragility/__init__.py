"""Fragility: how likely a limit state is, given an intensity measure of the ground motion."""
