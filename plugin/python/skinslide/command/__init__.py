"""The command `skinslide`: words in, exit code out. Nobody imports it."""
