#include "exrfiles.h"

#include "support.h"

#include <stdlib.h>
#include <string.h>

#define assert_exr(result) assert_int_equal((result), EXR_ERR_SUCCESS)

double exr_value(int32_t x, int32_t y, int32_t channel) {
    return 0.25 + (channel + 1) * ((x & 15) + 16 * (y & 7)) / 4.0;
}

/* For numbers from 2^-14 on that a half holds exactly. */
static uint16_t to_half(double value) {
    int exponent = 15;
    if (value == 0)
        return 0;
    for (; value >= 2; value /= 2)
        exponent++;
    for (; value < 1; value *= 2)
        exponent--;
    return (uint16_t)(exponent << 10 | (int)((value - 1) * 1024));
}

/* ---- A file in memory ---- */

static int64_t grow(exr_const_context_t context, void *data, const void *buffer, uint64_t size, uint64_t offset,
                    exr_stream_error_func_ptr_t fail) {
    (void)context, (void)fail;
    exr_file *file = data;
    int64_t end = (int64_t)(offset + size);
    if (end > file->size) {
        file->bytes = realloc(file->bytes, (size_t)end);
        memset(file->bytes + file->size, 0, (size_t)(end - file->size));
        file->size = end;
    }
    if (size)
        memcpy(file->bytes + offset, buffer, size);
    return (int64_t)size;
}

/* ---- Headers ---- */

static exr_attr_box2i_t window(int32_t left, int32_t top, int32_t right, int32_t bottom) {
    exr_attr_box2i_t box;
    box.min.x = left, box.min.y = top, box.max.x = right, box.max.y = bottom;
    return box;
}

static exr_attr_box2i_t data_window(const exr_part *part) {
    const int32_t *data = part->data;
    bool given = data[0] || data[1] || data[2] || data[3];
    return given ? window(data[0], data[1], data[2], data[3]) : window(0, 0, part->width - 1, part->height - 1);
}

static void declare(exr_context_t file, const exr_part *part) {
    int index;
    exr_attr_box2i_t display = window(0, 0, part->width - 1, part->height - 1), data = data_window(part);
    exr_attr_v2f_t centre = {0};
    assert_exr(exr_add_part(file, part->name, part->storage, &index));
    assert_exr(exr_initialize_required_attr(file, index, &display, &data, 1, &centre, 1, EXR_LINEORDER_INCREASING_Y,
                                            part->compression));
    for (int c = 0; c < 8 && part->channels[c]; c++) {
        int32_t sampling = part->sampling && (c == 7 || !part->channels[c + 1]) ? part->sampling : 1;
        assert_exr(exr_add_channel(file, index, part->channels[c], part->type, EXR_PERCEPTUALLY_LINEAR, sampling, sampling));
    }
    if (part->storage == EXR_STORAGE_TILED || part->storage == EXR_STORAGE_DEEP_TILED)
        assert_exr(exr_set_tile_descriptor(file, index, (uint32_t)part->tile, (uint32_t)part->tile,
                                           part->levels ? EXR_TILE_MIPMAP_LEVELS : EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN));
    if (part->storage == EXR_STORAGE_DEEP_SCANLINE || part->storage == EXR_STORAGE_DEEP_TILED)
        assert_exr(exr_set_version(file, index, 1));
    if (part->wrapmodes)
        assert_exr(exr_attr_set_string(file, index, "wrapmodes", part->wrapmodes));
}

/* ---- Texels ---- */

static int32_t channel_number(const exr_part *part, const char *name) {
    int32_t c = 0;
    while (strcmp(part->channels[c], name) != 0)
        c++;
    return c;
}

static void put(const exr_part *part, int32_t x, int32_t y, int32_t channel, uint8_t *to) {
    double value = exr_value(x, y, channel);
    uint16_t half = part->halves ? part->halves[y * part->width + x] : to_half(value);
    uint32_t whole = (uint32_t)value;
    float number = (float)value;
    if (part->type == EXR_PIXEL_HALF)
        memcpy(to, &half, 2);
    else if (part->type == EXR_PIXEL_UINT)
        memcpy(to, &whole, 4);
    else
        memcpy(to, &number, 4);
}

/* Texels from (x, y) on. Smaller levels take theirs from elsewhere, so that they differ. */
static void write_chunk(exr_context_t file, const exr_part *part, int index, const exr_chunk_info_t *chunk, int32_t x,
                        int32_t y) {
    exr_encode_pipeline_t encode = EXR_ENCODE_PIPELINE_INITIALIZER;
    uint8_t *texels[8] = {0};
    int16_t bytes = part->type == EXR_PIXEL_HALF ? 2 : 4;
    assert_exr(exr_encoding_initialize(file, index, chunk, &encode));
    for (int c = 0; c < encode.channel_count; c++) {
        exr_coding_channel_info_t *channel = &encode.channels[c];
        texels[c] = calloc((size_t)chunk->width * (size_t)chunk->height + 1, 4);
        for (int32_t j = 0; j < channel->height; j++)
            for (int32_t i = 0; i < channel->width; i++)
                put(part, x + i * channel->x_samples, y + j * channel->y_samples, channel_number(part, channel->channel_name),
                    texels[c] + (j * channel->width + i) * bytes);
        channel->encode_from_ptr = texels[c];
        channel->user_bytes_per_element = bytes;
        channel->user_data_type = (uint16_t)part->type;
        channel->user_pixel_stride = bytes;
        channel->user_line_stride = bytes * channel->width;
    }
    assert_exr(exr_encoding_choose_default_routines(file, index, &encode));
    assert_exr(exr_encoding_run(file, index, &encode));
    assert_exr(exr_encoding_destroy(file, &encode));
    for (int c = 0; c < 8; c++)
        free(texels[c]);
}

static void write_scanlines(exr_context_t file, const exr_part *part, int index) {
    exr_attr_box2i_t data = data_window(part);
    int32_t lines;
    assert_exr(exr_get_scanlines_per_chunk(file, index, &lines));
    for (int32_t y = data.min.y; y <= data.max.y; y += lines) {
        exr_chunk_info_t chunk;
        assert_exr(exr_write_scanline_chunk_info(file, index, y, &chunk));
        write_chunk(file, part, index, &chunk, data.min.x, y);
    }
}

static void write_level(exr_context_t file, const exr_part *part, int index, int level) {
    exr_attr_box2i_t data = data_window(part);
    int32_t width, height;
    assert_exr(exr_get_level_sizes(file, index, level, level, &width, &height));
    for (int32_t row = 0; row * part->tile < height; row++)
        for (int32_t column = 0; column * part->tile < width; column++) {
            exr_chunk_info_t chunk;
            assert_exr(exr_write_tile_chunk_info(file, index, column, row, level, level, &chunk));
            write_chunk(file, part, index, &chunk, data.min.x + column * part->tile + 7 * level,
                        data.min.y + row * part->tile + 3 * level);
        }
}

static void write_tiles(exr_context_t file, const exr_part *part, int index) {
    int32_t levels_x, levels_y;
    assert_exr(exr_get_tile_levels(file, index, &levels_x, &levels_y));
    for (int level = 0; level < levels_x; level++)
        write_level(file, part, index, level);
}

exr_file write_exr(const exr_part *parts, int count) {
    exr_file made = {0};
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    setup.user_data = &made;
    setup.write_fn = grow;
    exr_context_t file;
    assert_exr(exr_start_write(&file, "test", EXR_WRITE_FILE_DIRECTLY, &setup));
    for (int i = 0; i < count; i++)
        declare(file, &parts[i]);
    assert_exr(exr_write_header(file));
    for (int i = 0; i < count; i++) {
        if (parts[i].storage == EXR_STORAGE_SCANLINE)
            write_scanlines(file, &parts[i], i);
        if (parts[i].storage == EXR_STORAGE_TILED)
            write_tiles(file, &parts[i], i);
    }
    exr_finish(&file);
    return made;
}
