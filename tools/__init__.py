"""What makes documents and tries decoders, each run as ``python -m tools.NAME``."""
