"""Raster codecs that vmesh is measured against, and what each makes of a budget of bytes."""
