"""Files and opinions, put in place whole or not at all."""
