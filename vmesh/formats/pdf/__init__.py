"""Mesh -> PDF: Gouraud-shaded triangle meshes on a page, written by ourselves or by cairo."""
