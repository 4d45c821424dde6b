"""Numbers out of motions: joint angles."""
