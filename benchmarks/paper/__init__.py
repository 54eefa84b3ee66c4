"""The encoder as its paper measured it."""
