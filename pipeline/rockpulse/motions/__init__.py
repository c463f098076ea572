"""Which motions a set of records gives, of which earthquakes they are, and the one way through all of them."""
