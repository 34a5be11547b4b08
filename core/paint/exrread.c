/* Reads the texels of OpenEXR files, in memory or open, by OpenEXR's own C library, which only this file, exrheader.c and
 * exrwrite.c know. */
#define _POSIX_C_SOURCE 200809L /* pread */
#include "base.h"
#include "paint.h"

#include <errno.h>
#include <openexr.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LARGEST_HEADER ((int64_t)1 << 26)

/* What OpenEXR reads from, and the first error that it reports, which it would otherwise print to stderr. */
typedef struct source {
    const uint8_t *bytes; /* NULL: the descriptor is read, from offset on */
    int32_t descriptor;
    int64_t offset, size;
    int64_t readable; /* how much of it may be read so far */
    bool out_of_memory;
    char reported[256];
} source;

typedef struct owned_image {
    skinslide_image image; /* the first member, so that a pointer to it is one to the whole */
    ss_memory memory;
} owned_image;

static bool succeeds(source *from, exr_result_t result) {
    from->out_of_memory |= result == EXR_ERR_OUT_OF_MEMORY;
    return result == EXR_ERR_SUCCESS;
}

/* ---- What OpenEXR calls ---- */

static void hear(exr_const_context_t context, exr_result_t code, const char *message) {
    void *data = NULL;
    if (code != EXR_ERR_SUCCESS && exr_get_user_data(context, &data) == EXR_ERR_SUCCESS && data) {
        source *from = data;
        from->out_of_memory |= code == EXR_ERR_OUT_OF_MEMORY;
        if (!from->reported[0])
            snprintf(from->reported, sizeof from->reported, "%s", message ? message : "");
    }
}

/* Returns how many bytes could be read. */
static uint64_t read_open(const source *from, uint8_t *buffer, uint64_t count, uint64_t offset) {
    uint64_t done = 0;
    while (done < count) {
        ssize_t more = pread(from->descriptor, buffer + done, count - done, (off_t)((uint64_t)from->offset + offset + done));
        if (more == 0 || (more < 0 && errno != EINTR))
            break;
        done += more > 0 ? (uint64_t)more : 0;
    }
    return done;
}

/* Gives no more bytes than there are, as pread does. */
static int64_t read_bytes(exr_const_context_t context, void *data, void *buffer, uint64_t size, uint64_t offset,
                          exr_stream_error_func_ptr_t fail) {
    const source *from = data;
    uint64_t left = offset < (uint64_t)from->readable ? (uint64_t)from->readable - offset : 0;
    uint64_t count = size < left ? size : left;
    if (count && from->bytes)
        memcpy(buffer, from->bytes + offset, count);
    else if (count)
        count = read_open(from, buffer, count, offset);
    if (size && !count)
        fail(context, EXR_ERR_READ_IO, "%s byte %lld",
             from->readable < from->size ? "the header goes on after" : "the file ends at", (long long)from->readable);
    return (int64_t)count;
}

static int64_t tell_size(exr_const_context_t context, void *data) {
    (void)context;
    return ((const source *)data)->size;
}

/* Memory of zeros, so that a chunk that decompresses to too few bytes gives the same texels every time. */
static void *allocate(size_t size) {
    return calloc(1, size ? size : 1);
}

/* ---- Texels ---- */

/* Where the texels of chunks are written: to those of the display window. */
typedef struct target {
    const ss_exr_header *header;
    float *pixels;      /* of the display window */
    int64_t chunk_size; /* texels of the largest chunk */
    source *from;
} target;

static float texel(const uint8_t *bytes, bool is_half) {
    uint32_t low = bytes[0] | (uint32_t)bytes[1] << 8;
    if (is_half)
        return ss_half_to_float((uint16_t)low);
    uint32_t bits = low | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Takes one row of the chosen channel to the display window's row. */
static void copy_row(const target *to, const uint8_t *bytes, bool is_half, int64_t x, int64_t y, int64_t width) {
    const ss_exr_window *display = &to->header->display;
    if (y < display->y || y >= display->y + display->height)
        return;
    int64_t begin = x > display->x ? x : display->x;
    int64_t end = x + width < display->x + display->width ? x + width : display->x + display->width;
    float *row = to->pixels + (y - display->y) * display->width;
    for (int64_t column = begin; column < end; column++)
        row[column - display->x] = texel(bytes + (column - x) * (is_half ? 2 : 4), is_half);
}

/* A decompressed chunk holds row after row; a row holds the texels of channel after channel, in the file's order. A channel of
 * fewer texels than the image has them on some rows only. False where the bytes are too few: OpenEXR takes what is not
 * compressed as it comes. It would unpack by itself, but 3.1.5 takes routines for it that write through the null pointers of
 * channels that are not wanted. */
static bool unpack_chunk(const exr_decode_pipeline_t *decode, const target *to, int64_t x, int64_t y) {
    const uint8_t *bytes = decode->unpacked_buffer;
    uint64_t left = decode->unpacked_buffer == decode->packed_buffer ? decode->chunk.packed_size : decode->unpacked_alloc_size;
    for (int64_t row = y; row < y + decode->chunk.height; row++)
        for (int16_t c = 0; c < decode->channel_count; c++) {
            const exr_coding_channel_info_t *channel = &decode->channels[c];
            if (channel->y_samples < 1 || row % channel->y_samples != 0)
                continue;
            uint64_t size = (uint64_t)channel->width * (uint64_t)channel->bytes_per_element;
            if (channel->width < 0 || size > left)
                return false;
            if (c == to->header->channel)
                copy_row(to, bytes, channel->data_type == EXR_PIXEL_HALF, x, row, channel->width);
            bytes += size, left -= size;
        }
    return true;
}

static void *allocate_buffer(exr_transcoding_pipeline_buffer_id_t id, size_t size) {
    (void)id;
    return allocate(size);
}

static void free_buffer(exr_transcoding_pipeline_buffer_id_t id, void *buffer) {
    (void)id;
    free(buffer);
}

static bool decode_chunk(exr_const_context_t file, const exr_chunk_info_t *chunk, const target *to, int64_t x, int64_t y) {
    int part = to->header->part;
    exr_decode_pipeline_t decode = EXR_DECODE_PIPELINE_INITIALIZER;
    bool good = succeeds(to->from, exr_decoding_initialize(file, part, chunk, &decode));
    decode.alloc_fn = allocate_buffer;
    decode.free_fn = free_buffer;
    good = good && succeeds(to->from, exr_decoding_choose_default_routines(file, part, &decode));
    decode.unpack_and_convert_fn = NULL;
    good = good && succeeds(to->from, exr_decoding_run(file, part, &decode)) && decode.unpacked_buffer &&
           unpack_chunk(&decode, to, x, y);
    exr_decoding_destroy(file, &decode);
    return good;
}

/* OpenEXR takes a chunk of no bytes for one that is decompressed already; and it fills an uncompressed chunk that is too small,
 * or reaches past the end of the file, with zeros. */
static bool chunk_fits(const exr_chunk_info_t *chunk, const target *to) {
    bool packed = chunk->compression != EXR_COMPRESSION_NONE;
    uint64_t size = (uint64_t)to->from->size;
    return chunk->width > 0 && chunk->height > 0 && (int64_t)chunk->width * chunk->height <= to->chunk_size &&
           chunk->unpacked_size <= SS_LARGEST_CHUNK && chunk->packed_size <= chunk->unpacked_size &&
           (packed ? chunk->packed_size > 0 : chunk->packed_size == chunk->unpacked_size) && chunk->data_offset <= size &&
           chunk->packed_size <= size - chunk->data_offset;
}

/* Returns the first row that cannot be decoded, or a row beyond the last. */
static int64_t decode_scanlines(exr_const_context_t file, const target *to) {
    const ss_exr_window *data = &to->header->data;
    int64_t y = data->y;
    for (exr_chunk_info_t chunk; y < data->y + data->height; y += to->header->chunk_height)
        if (!succeeds(to->from, exr_read_scanline_chunk_info(file, to->header->part, (int)y, &chunk)) ||
            !chunk_fits(&chunk, to) || chunk.width != data->width || !decode_chunk(file, &chunk, to, data->x, y))
            break;
    return y;
}

static int64_t decode_tiles(exr_const_context_t file, const target *to) {
    const ss_exr_window *data = &to->header->data;
    int64_t y = data->y, width = to->header->chunk_width;
    for (int row = 0; y < data->y + data->height; row++, y += to->header->chunk_height)
        for (int column = 0; column * width < data->width; column++) {
            exr_chunk_info_t chunk;
            if (!succeeds(to->from, exr_read_tile_chunk_info(file, to->header->part, column, row, 0, 0, &chunk)) ||
                !chunk_fits(&chunk, to) || !decode_chunk(file, &chunk, to, data->x + column * width, y))
                return y;
        }
    return y;
}

static int64_t least(int64_t a, int64_t b) {
    return a < b ? a : b;
}

static skinslide_status decode_texels(exr_const_context_t file, target *to, skinslide_error *error) {
    const ss_exr_header *header = to->header;
    const ss_exr_window *data = &header->data;
    to->chunk_size = least(header->chunk_width, data->width) * least(header->chunk_height, data->height);
    to->from->reported[0] = 0;
    int64_t end = header->tiled ? decode_tiles(file, to) : decode_scanlines(file, to);
    if (to->from->out_of_memory)
        return ss_out_of_memory(error);
    if (end < data->y + data->height)
        return ss_fail(error, SKINSLIDE_BAD_IMAGE, "truncated or corrupt: row %lld of %lld cannot be decoded%s%s",
                       (long long)(end - data->y), (long long)data->height, to->from->reported[0] ? ": " : "",
                       to->from->reported);
    return SKINSLIDE_OK;
}

/* ---- Decoding ---- */

static char *copy_name(ss_memory *memory, const ss_exr_header *header) {
    size_t size = strlen(header->part_name) + 1 + strlen(header->channel_name) + 1;
    char *copy = SS_NEW(memory, char, (int64_t)size);
    if (copy)
        snprintf(copy, size, "%s%s%s", header->part_name, header->part_name[0] ? "." : "", header->channel_name);
    return copy;
}

static skinslide_status decode_image(exr_const_context_t file, const ss_exr_header *header, source *from, skinslide_image **out,
                                     skinslide_error *error) {
    target to = {.header = header, .from = from};
    ss_memory memory = {0};
    owned_image *owned = SS_NEW(&memory, owned_image, 1);
    to.pixels = SS_NEW(&memory, float, header->display.width * header->display.height);
    char *name = copy_name(&memory, header);
    skinslide_status status = memory.failed ? ss_out_of_memory(error) : decode_texels(file, &to, error);
    if (status) {
        ss_free(&memory);
        return status;
    }
    owned->memory = memory;
    owned->image = (skinslide_image){.size = sizeof owned->image,
                                     .width = (int32_t)header->display.width,
                                     .height = (int32_t)header->display.height,
                                     .wrap_s = header->wrap_s,
                                     .wrap_t = header->wrap_t,
                                     .pixels = to.pixels,
                                     .channel = name};
    *out = &owned->image;
    return SKINSLIDE_OK;
}

static skinslide_status decode(source *from, const char *channel, skinslide_image **out, skinslide_error *error) {
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    setup.error_handler_fn = hear;
    setup.alloc_fn = allocate;
    setup.free_fn = free;
    setup.user_data = from;
    setup.read_fn = read_bytes;
    setup.size_fn = tell_size;
    setup.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    exr_context_t file = NULL;
    from->readable = least(from->size, LARGEST_HEADER);
    bool opened = succeeds(from, exr_start_read(&file, "image", &setup));
    from->readable = from->size;
    ss_exr_header header;
    skinslide_status status;
    if (from->out_of_memory)
        status = ss_out_of_memory(error);
    else if (!opened)
        status = ss_fail(error, SKINSLIDE_BAD_IMAGE, "not an OpenEXR file, or a truncated or corrupt one%s%s",
                         from->reported[0] ? ": " : "", from->reported);
    else
        status = ss_exr_read_header(file, channel ? channel : "", from->size, &header, error);
    if (!status)
        status = decode_image(file, &header, from, out, error);
    exr_finish(&file);
    return status;
}

static skinslide_status refuse_arguments(skinslide_error *error) {
    return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no bytes, or no place for the image");
}

skinslide_status skinslide_exr_decode(const uint8_t *bytes, int64_t size, const char *channel, skinslide_image **out,
                                      skinslide_error *error) {
    static const uint8_t nothing = 0;
    if (!out || size < 0 || (size && !bytes))
        return refuse_arguments(error);
    source from = {.bytes = bytes ? bytes : &nothing, .size = size};
    return decode(&from, channel, out, error);
}

skinslide_status skinslide_exr_read(int32_t descriptor, int64_t offset, int64_t size, const char *channel,
                                    skinslide_image **out, skinslide_error *error) {
    if (!out || offset < 0 || size < 0 || size > INT64_MAX - offset)
        return refuse_arguments(error);
    source from = {.descriptor = descriptor, .offset = offset, .size = size};
    return decode(&from, channel, out, error);
}

void skinslide_image_destroy(skinslide_image *image) {
    if (image) {
        ss_memory memory = ((owned_image *)image)->memory;
        ss_free(&memory);
    }
}
