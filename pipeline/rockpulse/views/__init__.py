"""What people look at: text, pictures, differences, and the report. A view reads answers and computes nothing."""
