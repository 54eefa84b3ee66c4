"""Mesh -> SVG: flat colours and linear gradients on triangles or on regions of several."""
