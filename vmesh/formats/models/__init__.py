"""Mesh <-> the files of modelling programs: PLY, OBJ, glTF and the canonical text."""
