"""The rigid body: its corners, restitution and restraints, and the pedestal or floor under it."""
