"""Answers of a results file as a table: which rows, which columns, and the file that they are written to."""
