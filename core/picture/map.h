/* The canvas of maps from inside, for its tests. */
#ifndef SKINSLIDE_MAPDRAW_H
#define SKINSLIDE_MAPDRAW_H

#include "egl.h"
#include "skinslide/picture.h"

/* skinslide_map_canvas_create, with EGL by another loader. */
skinslide_status ss_map_canvas_create(int32_t side, const ss_device_request *request, skinslide_map_canvas **out,
                                      skinslide_error *error);

#endif
