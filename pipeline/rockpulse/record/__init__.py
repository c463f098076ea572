"""One record and its processing: conditioning, components, rotation, half-waves, intensity."""
