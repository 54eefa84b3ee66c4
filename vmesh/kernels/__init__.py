"""Compiled loops: plain arrays in, plain arrays out. The only package that imports Numba.

A kernel assumes the shapes, dtypes and contiguity that its docstring states; the callers cast and
check. Kernels call kernels of any file here, since a change in one makes the compilation cache of
all out of date (``jit``). Tables from elsewhere are passed as arguments: the cache does not notice
a change in those.
"""
