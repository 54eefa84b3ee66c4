"""What travels with a picture: EXIF, ICC profiles, and what documents say about it."""
