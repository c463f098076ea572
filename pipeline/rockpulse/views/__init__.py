"""Views of results: text, pictures, comparisons, and the report. A view reads results and computes no responses."""
