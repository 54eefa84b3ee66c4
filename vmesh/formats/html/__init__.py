"""Mesh -> a page, or an element of pages, that shows it in a browser."""
