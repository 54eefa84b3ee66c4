"""Mesh -> everything else, and pictures -> arrays. ``registry`` holds the table of formats."""
