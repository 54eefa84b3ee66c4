"""The entropy coder of a .vmesh file and the models of the parts of a mesh (spec, sections 5 to 8).

One kernel for each part serves both directions: it either takes values from its arrays and writes
them, or reads them and puts them there, as ``coder[DECODING]`` says, so that the two cannot drift
apart.
Every loop over a decoded number is bounded, and no index that depends on one is used unchecked:
these kernels read hostile files.
"""
