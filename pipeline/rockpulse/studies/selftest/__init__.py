"""Stored cases that test an installation, and a conventional solver to compare with."""
