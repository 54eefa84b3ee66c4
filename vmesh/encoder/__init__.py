"""Pixels -> Mesh. ``pipeline`` names the stages in order; there is a module for each."""
