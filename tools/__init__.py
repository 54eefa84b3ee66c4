"""Programs that make documents and try decoders, each run as ``python -m tools.NAME``."""
