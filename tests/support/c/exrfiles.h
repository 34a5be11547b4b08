/* OpenEXR files of every kind for the tests of the reader, written by OpenEXR's own library. */
#ifndef SKINSLIDE_TEST_EXRFILES_H
#define SKINSLIDE_TEST_EXRFILES_H

#include <openexr.h>
#include <stdbool.h>
#include <stdint.h>

/* One part. Members left 0 mean scanlines, no compression, whole numbers, and a data window equal to the display window. */
typedef struct exr_part {
    const char *name;
    const char *channels[8]; /* up to the first NULL */
    exr_storage_t storage;
    exr_compression_t compression;
    exr_pixel_type_t type;
    int32_t width, height; /* of the display window, whose corner is (0, 0) */
    int32_t data[4];       /* the data window's first x and y, last x and y; all 0: the display window */
    int32_t tile;          /* texels along a side of tiles */
    bool levels;           /* tiles of smaller levels too, with other values */
    int32_t sampling;      /* of the last channel; 0 means 1 */
    const char *wrapmodes;
    const uint16_t
        *halves; /* [height][width] for every channel, in place of exr_value; only for type half and without a data window */
} exr_part;

typedef struct exr_file {
    uint8_t *bytes;
    int64_t size;
} exr_file;

/* The caller frees bytes. Deep parts have a header but no texels. */
exr_file write_exr(const exr_part *parts, int count);

/* The texel (x, y) of a channel, which a half holds exactly. */
double exr_value(int32_t x, int32_t y, int32_t channel);

#endif
