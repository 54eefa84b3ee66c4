"""A page on what the encoder makes of photographs; it needs the encoder and the formats both."""
