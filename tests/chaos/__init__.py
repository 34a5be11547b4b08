"""Attacks on the tool: whatever happens to it, files are what they were or whole and new, and what ended it is said."""
