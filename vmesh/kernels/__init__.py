"""Compiled loops: plain arrays in, plain arrays out. The only package that imports Numba.

A kernel assumes the shapes, dtypes and contiguity that its docstring states; the callers cast and
check. It calls kernels of its own file only, because the compilation cache of a kernel does not
notice changes in other files, and takes tables as arguments for the same reason.
"""
