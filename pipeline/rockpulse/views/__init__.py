"""The views for people: text, pictures, differences, and the report. A view reads answers and computes nothing."""
