"""What the example makers share: MakeHuman's data, skinning, choice of faces, and the two USD files."""
