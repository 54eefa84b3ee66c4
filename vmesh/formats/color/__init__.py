"""Colours and the spaces they are numbers of: ICC profiles, and the way to sRGB by littleCMS."""
