"""Metadata of a picture: EXIF, ICC profiles, and its description in documents."""
