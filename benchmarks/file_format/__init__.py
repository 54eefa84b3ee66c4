"""Size and speed of the file format."""
