"""Large pictures in tiles: each tile is worked on as a picture, then all are joined."""
