"""Parts that several views need: tables, marks and the notes that explain them."""
