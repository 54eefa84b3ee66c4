"""Mesh -> pixels, and pixels from and to image files."""
