"""Responses to impulses: sequences in closed form, and the half-waves of a record one by one."""
