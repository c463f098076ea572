"""Export of a results file as a table: selection of rows and columns, and the file to write."""
