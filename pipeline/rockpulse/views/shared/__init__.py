"""What several views need: aligned text, marks and the notes that explain them."""
