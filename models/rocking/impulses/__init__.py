"""Responses to impulses: sequences in closed form, and trains of single impulses such as the half-waves of a record."""
