"""Impulses."""
