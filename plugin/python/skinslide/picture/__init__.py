"""What sliding does, to be looked at: pictures, maps, a page."""
