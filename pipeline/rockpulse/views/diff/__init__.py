"""Comparison of two results files."""
