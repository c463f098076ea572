"""One record and what is made of it: conditioning, components, rotation, half-waves, intensity."""
