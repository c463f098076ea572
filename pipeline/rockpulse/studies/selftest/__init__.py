"""Stored cases that test an installation, and a conventional solver for comparison."""
