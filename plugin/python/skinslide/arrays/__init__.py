"""The C library on numpy arrays: no USD here."""
