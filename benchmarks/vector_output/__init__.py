"""Vector output: its bytes, and how close other programs draw it to our raster."""
