"""Mesh <-> files of modelling programs, PLY, OBJ and glTF, and the canonical text."""
