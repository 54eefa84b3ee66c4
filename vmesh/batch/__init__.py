"""Many photographs at once: what is to be made of them, and who makes it."""
