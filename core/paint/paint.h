/* What the files that read painted textures, and those that draw maps, share. */
#ifndef SS_PAINT_H
#define SS_PAINT_H

#include "mesh.h"
#include "skinslide/paint.h"

/* UDIM tiles, numbered by rows of ten: 1001 to 10000. */
enum { SS_FIRST_TILE = 1001, SS_TILE_COLUMNS = 10, SS_TILE_ROWS = 900 };

#endif
