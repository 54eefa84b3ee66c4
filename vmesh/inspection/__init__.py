"""The stages of an encoding, drawn: what ``vmesh inspect`` shows."""
