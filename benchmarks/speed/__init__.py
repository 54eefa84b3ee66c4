"""Speed of decoders and of the command line."""
