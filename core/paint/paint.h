/* What the files that read painted textures, and those that draw maps, share. */
#ifndef SKINSLIDE_PAINT_H
#define SKINSLIDE_PAINT_H

/* UDIM tiles, numbered by rows of ten: 1001 to 10000. */
enum { SS_FIRST_TILE = 1001, SS_TILE_COLUMNS = 10, SS_TILE_ROWS = 900 };

#endif
