"""Writes set-ups."""
