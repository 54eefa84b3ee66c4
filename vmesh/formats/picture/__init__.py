"""Photographs in files -> arrays, whatever holds them and however their samples are stored."""
