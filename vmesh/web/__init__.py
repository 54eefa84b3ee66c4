"""The second decoder and the viewer, in JavaScript, and what joins their modules to one script."""
