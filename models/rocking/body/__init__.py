"""The rigid body: corners, restitution, restraints, and the pedestal or floor under it."""
