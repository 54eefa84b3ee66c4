"""Quality of vmesh and of other lossy codecs at equal bytes."""
