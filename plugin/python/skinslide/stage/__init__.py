"""Fetches what SkinSlideAPI means from a stage; writes nothing."""
