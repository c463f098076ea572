"""What a rigid body is: its corners, its restitution, what holds it and what it stands on."""
