"""Views of results: text, pictures, differences, and the report. A view reads results and computes nothing."""
