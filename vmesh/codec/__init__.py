"""Mesh <-> the bytes of a .vmesh file. The specification is ``spec/vmesh.md``.

``layout`` names every byte outside the coded mesh and needs neither Numba nor NumPy, so that a
file can be listed quickly; ``mesh_coder`` codes the mesh; ``reader`` and ``writer`` join the two,
``policy`` says what becomes of damage, ``stream`` opens what a caller names.
"""
