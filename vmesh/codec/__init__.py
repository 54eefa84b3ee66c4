"""Mesh <-> the bytes of a .vmesh file. The specification is ``spec/vmesh.md``.

``layout`` names every byte outside the coded payloads and needs neither Numba nor NumPy, so that
a file can be listed quickly; ``payloads`` codes what is inside; ``reader`` and ``writer`` join
the two; ``stream`` opens what a caller names.
"""
