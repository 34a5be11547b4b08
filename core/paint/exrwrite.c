/* Makes OpenEXR files in memory by OpenEXR's own C library, which only this file and exrread.c know. */
#include "paint.h"

#include <openexr.h>
#include <stdlib.h>
#include <string.h>

#define LONGEST_NAME 31 /* of a channel, in files that every reader knows */

/* What OpenEXR writes to, and its first error. */
typedef struct sink {
    uint8_t *bytes;
    size_t size, capacity;
    exr_result_t failed;
    exr_result_t (*compress)(exr_encode_pipeline_t *encode); /* OpenEXR's own */
} sink;

static bool succeeds(sink *to, exr_result_t result) {
    if (result != EXR_ERR_SUCCESS && to->failed == EXR_ERR_SUCCESS)
        to->failed = result;
    return result == EXR_ERR_SUCCESS;
}

/* Keeps OpenEXR from printing. The error cannot be kept here: asking for the user's data waits for a lock that OpenEXR 3.1.5
 * holds while it reports. */
static void hear(exr_const_context_t context, exr_result_t code, const char *message) {
    (void)context, (void)code, (void)message;
}

static void *allocate(size_t size) {
    return calloc(1, size ? size : 1);
}

static bool make_room(sink *to, size_t size) {
    if (size <= to->capacity)
        return true;
    size_t capacity = size > 2 * to->capacity ? size : 2 * to->capacity;
    uint8_t *bytes = allocate(capacity);
    if (!bytes)
        return false;
    if (to->size)
        memcpy(bytes, to->bytes, to->size);
    free(to->bytes);
    to->bytes = bytes, to->capacity = capacity;
    return true;
}

/* OpenEXR leaves room for its table of offsets and comes back to it at the end. */
static int64_t write_bytes(exr_const_context_t context, void *data, const void *buffer, uint64_t size, uint64_t offset,
                           exr_stream_error_func_ptr_t fail) {
    sink *to = data;
    if (!make_room(to, (size_t)(offset + size))) {
        to->failed = EXR_ERR_OUT_OF_MEMORY;
        fail(context, EXR_ERR_OUT_OF_MEMORY, "%s", skinslide_status_text(SKINSLIDE_OUT_OF_MEMORY));
        return -1;
    }
    if (size)
        memcpy(to->bytes + offset, buffer, (size_t)size);
    if (offset + size > to->size)
        to->size = (size_t)(offset + size);
    return (int64_t)size;
}

static const char *wrap_name(skinslide_wrap wrap) {
    static const char *const names[] = {"clamp", "periodic", "mirror", "black"};
    return names[wrap];
}

static skinslide_status check_channels(const skinslide_channel *channels, int32_t count, int32_t width, int32_t height,
                                       skinslide_error *error) {
    if (width < 1 || height < 1 || width > SS_LARGEST_IMAGE || height > SS_LARGEST_IMAGE)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "an image of %d x %d; each must be 1 to %d", width, height,
                       SS_LARGEST_IMAGE);
    for (int32_t c = 0; c < count; c++) {
        if (!channels[c].name || !channels[c].name[0] || strlen(channels[c].name) > LONGEST_NAME || !channels[c].pixels)
            return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "channel %d has no pixels, or no name of 1 to %d bytes", c,
                           LONGEST_NAME);
        for (int32_t other = 0; other < c; other++)
            if (strcmp(channels[other].name, channels[c].name) == 0)
                return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "channel %s comes twice", channels[c].name);
    }
    return SKINSLIDE_OK;
}

static bool write_header(exr_context_t file, sink *to, const skinslide_channel *channels, int32_t count, int32_t width,
                         int32_t height, skinslide_wrap wrap) {
    int part = 0;
    bool good = succeeds(to, exr_add_part(file, NULL, EXR_STORAGE_SCANLINE, &part)) &&
                succeeds(to, exr_initialize_required_attr_simple(file, part, width, height, EXR_COMPRESSION_ZIP)) &&
                succeeds(to, exr_attr_set_string(file, part, "wrapmodes", wrap_name(wrap)));
    for (int32_t c = 0; good && c < count; c++)
        good = succeeds(to, exr_add_channel(file, part, channels[c].name, EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LINEAR, 1, 1));
    return good && succeeds(to, exr_write_header(file));
}

static const float *pixels_of(const skinslide_channel *channels, const char *name) {
    while (strcmp(channels->name, name) != 0)
        channels++;
    return channels->pixels;
}

/* Readers take a chunk that compressed to no fewer bytes for an uncompressed one, which OpenEXR 3.1.5 forgets when it writes:
 * such a chunk is stored uncompressed. */
static exr_result_t compress(exr_encode_pipeline_t *encode) {
    sink *to = encode->encoding_user_data;
    exr_result_t result = to->compress(encode);
    if (result == EXR_ERR_SUCCESS && encode->compressed_bytes == encode->packed_bytes)
        memcpy(encode->compressed_buffer, encode->packed_buffer, encode->packed_bytes);
    return result;
}

static bool write_rows(exr_context_t file, sink *to, const skinslide_channel *channels, int32_t width, int32_t y) {
    exr_chunk_info_t chunk;
    exr_encode_pipeline_t encode = EXR_ENCODE_PIPELINE_INITIALIZER;
    if (!succeeds(to, exr_write_scanline_chunk_info(file, 0, y, &chunk)))
        return false;
    bool good = succeeds(to, exr_encoding_initialize(file, 0, &chunk, &encode));
    for (int16_t c = 0; good && c < encode.channel_count; c++) {
        exr_coding_channel_info_t *channel = &encode.channels[c];
        channel->encode_from_ptr = (const uint8_t *)(pixels_of(channels, channel->channel_name) + (int64_t)y * width);
        channel->user_bytes_per_element = sizeof(float);
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_pixel_stride = sizeof(float);
        channel->user_line_stride = (int32_t)sizeof(float) * width;
    }
    good = good && succeeds(to, exr_encoding_choose_default_routines(file, 0, &encode));
    to->compress = encode.compress_fn;
    encode.encoding_user_data = to;
    encode.compress_fn = compress;
    good = good && succeeds(to, exr_encoding_run(file, 0, &encode));
    exr_encoding_destroy(file, &encode);
    return good;
}

static bool write_file(sink *to, const skinslide_channel *channels, int32_t count, int32_t width, int32_t height,
                       skinslide_wrap wrap) {
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    setup.error_handler_fn = hear;
    setup.alloc_fn = allocate;
    setup.free_fn = free;
    setup.user_data = to;
    setup.write_fn = write_bytes;
    exr_context_t file = NULL;
    int32_t lines = 1;
    if (!succeeds(to, exr_start_write(&file, "image", EXR_WRITE_FILE_DIRECTLY, &setup)))
        return false;
    bool good = write_header(file, to, channels, count, width, height, wrap) &&
                exr_get_scanlines_per_chunk(file, 0, &lines) == EXR_ERR_SUCCESS;
    for (int32_t y = 0; good && y < height; y += lines)
        good = write_rows(file, to, channels, width, y);
    return (succeeds(to, exr_finish(&file))) && good;
}

/* skinslide_exr_encode, once the channels are taken. */
static skinslide_status encode(const skinslide_channel *channels, int32_t channel_count, int32_t width, int32_t height,
                               skinslide_wrap wrap, skinslide_bytes **out, skinslide_error *error) {
    skinslide_status status = check_channels(channels, channel_count, width, height, error);
    if (status)
        return status;
    sink to = {0};
    skinslide_bytes *made = allocate(sizeof *made);
    if (made && write_file(&to, channels, channel_count, width, height, wrap)) {
        *made = (skinslide_bytes){(int64_t)to.size, to.bytes};
        *out = made;
        return SKINSLIDE_OK;
    }
    bool out_of_memory = !made || to.failed == EXR_ERR_OUT_OF_MEMORY;
    free(to.bytes);
    free(made);
    return out_of_memory
               ? ss_out_of_memory(error)
               : ss_fail(error, SKINSLIDE_BAD_IMAGE, "cannot be written: %s", exr_get_default_error_message(to.failed));
}

skinslide_status skinslide_exr_encode(const skinslide_channel *channels, int32_t channel_count, int32_t width, int32_t height,
                                      skinslide_wrap wrap, skinslide_bytes **out, skinslide_error *error) {
    if (!out || (unsigned)wrap > SKINSLIDE_WRAP_BLACK)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no place for the bytes, or no such wrap");
    if (!channels || channel_count < 1)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no channels to write");
    const skinslide_channel standard = SKINSLIDE_CHANNEL_DEFAULT;
    ss_memory memory = {0};
    skinslide_channel *own = SS_NEW(&memory, skinslide_channel, channel_count);
    skinslide_status status =
        own ? ss_take_all(channels, channel_count, "skinslide_channel", own, sizeof *own, &standard, error)
            : ss_out_of_memory(error);
    if (!status)
        status = encode(own, channel_count, width, height, wrap, out, error);
    ss_free(&memory);
    return status;
}

void skinslide_bytes_destroy(skinslide_bytes *bytes) {
    if (bytes) {
        free((void *)bytes->data);
        free(bytes);
    }
}
