"""Slides the frames of a shot."""
