"""Sheets: pictures, drawings and words at their places, and their writers."""
