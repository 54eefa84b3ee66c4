"""Large pictures in tiles: each is worked on as a picture of its own, then all are joined."""
