/* Reads OpenEXR files, in memory or open, by OpenEXR's own C library, which only this file and exrwrite.c know. Headers are
 * untrusted: what they claim is held against limits and against the size of the file before memory is taken. */
#define _POSIX_C_SOURCE 200809L /* pread */
#include "base.h"
#include "paint.h"

#include <errno.h>
#include <math.h>
#include <openexr.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LARGEST_CHUNK  ((uint64_t)1 << 30)
#define LARGEST_HEADER ((int64_t)1 << 26)
#define MOST_CHUNKS    (1 << 22)

/* What OpenEXR reads from, and the first error that it reports, which it would otherwise print to stderr. */
typedef struct source {
    const uint8_t *bytes; /* NULL: the descriptor is read, from offset on */
    int32_t descriptor;
    int64_t offset, size;
    int64_t readable; /* how much of it may be read so far */
    bool out_of_memory;
    char said[256];
} source;

/* One channel of one part that is not deep. */
typedef struct selection {
    int part, part_count;
    const exr_attr_chlist_t *channels;
    int32_t channel; /* -1: none */
} selection;

typedef struct window {
    int64_t x, y, width, height;
} window;

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
        if (!from->said[0])
            snprintf(from->said, sizeof from->said, "%s", message ? message : "");
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

/* ---- Which channel ---- */

static bool is_deep(exr_const_context_t file, int part) {
    exr_storage_t storage;
    return exr_get_storage(file, part, &storage) != EXR_ERR_SUCCESS ||
           (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED);
}

static const char *part_name(exr_const_context_t file, int part) {
    const char *name = NULL;
    return exr_get_name(file, part, &name) == EXR_ERR_SUCCESS && name ? name : "";
}

static int32_t channel_named(const exr_attr_chlist_t *channels, const char *name) {
    for (int32_t c = 0; c < channels->num_channels; c++)
        if (strcmp(channels->entries[c].name.str, name) == 0)
            return c;
    return -1;
}

/* The name of a channel without that of its layer: "R" of "paint.R". */
static const char *own_name(const exr_attr_chlist_t *channels, int32_t channel) {
    const char *name = channels->entries[channel].name.str, *dot = strrchr(name, '.');
    return dot ? dot + 1 : name;
}

/* The length of the name of the layer that all channels are of; 0 where they are of none, or of several. */
static size_t layer_length(const exr_attr_chlist_t *channels) {
    const char *first = channels->entries[0].name.str;
    size_t length = (size_t)(own_name(channels, 0) - first);
    for (int32_t c = 1; c < channels->num_channels; c++) {
        const char *name = channels->entries[c].name.str;
        if ((size_t)(own_name(channels, c) - name) != length || strncmp(name, first, length) != 0)
            return 0;
    }
    return length;
}

/* R, else Y, else the first that is not A: of the layer, where all channels are of one. */
static int32_t default_channel(const exr_attr_chlist_t *channels) {
    static const char *const preferred[] = {"R", "Y"};
    size_t layer = channels->num_channels ? layer_length(channels) : 0;
    for (size_t i = 0; i < sizeof preferred / sizeof *preferred; i++)
        for (int32_t c = 0; c < channels->num_channels; c++)
            if (strcmp(channels->entries[c].name.str + layer, preferred[i]) == 0)
                return c;
    for (int32_t c = 0; c < channels->num_channels; c++)
        if (strcmp(channels->entries[c].name.str + layer, "A") != 0)
            return c;
    return channels->num_channels - 1;
}

/* The channel of a part that has a name: CHANNEL, or PART.CHANNEL. */
static int32_t channel_of_part(exr_const_context_t file, int part, const exr_attr_chlist_t *channels, const char *wanted,
                               bool dotted) {
    if (!wanted[0])
        return default_channel(channels);
    if (!dotted)
        return channel_named(channels, wanted);
    const char *name = part_name(file, part);
    size_t length = strlen(name);
    bool names_part = length && strncmp(wanted, name, length) == 0 && wanted[length] == '.';
    return names_part ? channel_named(channels, wanted + length + 1) : -1;
}

/* Appends ", NAME" or ", PART.NAME" for every channel, as far as there is room. */
static void list_channels(exr_const_context_t file, int part_count, char *text, size_t size) {
    size_t used = 0;
    text[0] = 0;
    for (int part = 0; part < part_count; part++) {
        const exr_attr_chlist_t *channels = NULL;
        const char *name = part_count > 1 ? part_name(file, part) : "";
        if (is_deep(file, part) || exr_get_channels(file, part, &channels) != EXR_ERR_SUCCESS)
            continue;
        for (int32_t c = 0; c < channels->num_channels && used < size; c++)
            used += (size_t)snprintf(text + used, size - used, "%s%s%s%s", used ? ", " : "", name, name[0] ? "." : "",
                                     channels->entries[c].name.str);
    }
}

static skinslide_status no_channel(exr_const_context_t file, int part_count, bool all_deep, const char *wanted,
                                   skinslide_error *error) {
    char listed[256];
    if (all_deep)
        return ss_fail(error, SKINSLIDE_BAD_IMAGE, "the image is deep; flatten it");
    list_channels(file, part_count, listed, sizeof listed);
    return ss_fail(error, SKINSLIDE_BAD_IMAGE, "there is no channel %.95s; the file has %s", wanted,
                   listed[0] ? listed : "no channels");
}

static skinslide_status choose_channel(exr_const_context_t file, const char *wanted, selection *chosen,
                                       skinslide_error *error) {
    bool all_deep = true;
    if (exr_get_count(file, &chosen->part_count) != EXR_ERR_SUCCESS)
        return ss_fail(error, SKINSLIDE_BAD_IMAGE, "the file has no parts");
    for (int dotted = 0; dotted < 2; dotted++)
        for (int part = 0; part < chosen->part_count; part++) {
            if (is_deep(file, part) || exr_get_channels(file, part, &chosen->channels) != EXR_ERR_SUCCESS)
                continue;
            all_deep = false;
            chosen->part = part;
            chosen->channel = channel_of_part(file, part, chosen->channels, wanted, dotted);
            if (chosen->channel >= 0)
                return SKINSLIDE_OK;
        }
    return no_channel(file, chosen->part_count, all_deep, wanted, error);
}

/* OpenEXR 3.1.5 cannot read DWA in C, and takes a chunk of B44 that is as large as its texels for an uncompressed one. */
static skinslide_status check_compression(exr_const_context_t file, const selection *chosen, skinslide_error *error) {
    static const char *const lossy[] = {"B44", "B44A", "DWAA", "DWAB"};
    exr_compression_t compression = EXR_COMPRESSION_LAST_TYPE;
    bool known =
        exr_get_compression(file, chosen->part, &compression) == EXR_ERR_SUCCESS && compression <= EXR_COMPRESSION_DWAB;
    if (known && compression <= EXR_COMPRESSION_PXR24)
        return SKINSLIDE_OK;
    char which[32] = "a compression that is not known";
    if (known)
        snprintf(which, sizeof which, "compression %s is not read", lossy[compression - EXR_COMPRESSION_B44]);
    return ss_fail(error, SKINSLIDE_UNSUPPORTED, "%s; write the file as ZIP or PIZ", which);
}

static skinslide_status check_channel(const selection *chosen, skinslide_error *error) {
    const exr_attr_chlist_entry_t *channel = &chosen->channels->entries[chosen->channel];
    const char *name = channel->name.str;
    if (channel->pixel_type != EXR_PIXEL_HALF && channel->pixel_type != EXR_PIXEL_FLOAT)
        return ss_fail(error, SKINSLIDE_UNSUPPORTED, "channel %.95s holds whole numbers (uint); it must be half or float",
                       name);
    if (channel->x_sampling != 1 || channel->y_sampling != 1)
        return ss_fail(error, SKINSLIDE_UNSUPPORTED, "channel %.95s has fewer texels than the image (sampling %d, %d)", name,
                       channel->x_sampling, channel->y_sampling);
    return SKINSLIDE_OK;
}

/* ---- What the header claims ---- */

static window window_of(exr_attr_box2i_t box) {
    return (window){box.min.x, box.min.y, (int64_t)box.max.x - box.min.x + 1, (int64_t)box.max.y - box.min.y + 1};
}

static skinslide_status check_window(const char *what, window w, skinslide_error *error) {
    if (w.width < 1 || w.height < 1)
        return ss_fail(error, SKINSLIDE_BAD_IMAGE, "the %s window has no texels (%lld x %lld)", what, (long long)w.width,
                       (long long)w.height);
    if (w.width > SS_LARGEST_IMAGE * (int64_t)SS_LARGEST_IMAGE || w.height > SS_LARGEST_IMAGE * (int64_t)SS_LARGEST_IMAGE ||
        w.width * w.height > SS_LARGEST_IMAGE * (int64_t)SS_LARGEST_IMAGE)
        return ss_fail(error, SKINSLIDE_UNSUPPORTED, "the %s window is %lld x %lld; more texels than %d x %d are refused", what,
                       (long long)w.width, (long long)w.height, SS_LARGEST_IMAGE, SS_LARGEST_IMAGE);
    return SKINSLIDE_OK;
}

static skinslide_status read_windows(exr_const_context_t file, int part, window *data, window *display,
                                     skinslide_error *error) {
    exr_attr_box2i_t data_box, display_box;
    if (exr_get_data_window(file, part, &data_box) != EXR_ERR_SUCCESS ||
        exr_get_display_window(file, part, &display_box) != EXR_ERR_SUCCESS)
        return ss_fail(error, SKINSLIDE_BAD_IMAGE, "the header has no data window or no display window");
    *data = window_of(data_box), *display = window_of(display_box);
    skinslide_status status = check_window("data", *data, error);
    return status ? status : check_window("display", *display, error);
}

skinslide_status ss_check_most(const char *before, uint64_t count, const char *of, uint64_t most, skinslide_status status,
                               skinslide_error *error) {
    if (count <= most)
        return SKINSLIDE_OK;
    return ss_fail(error, status, "%s%llu %s; more than %llu are refused", before, (unsigned long long)count, of,
                   (unsigned long long)most);
}

static skinslide_status refuse_storage(skinslide_error *error) {
    return ss_fail(error, SKINSLIDE_BAD_IMAGE, "the header does not say how the texels are stored");
}

/* Every chunk has eight bytes in the table of offsets and eight of its own at least, so a header cannot claim more of them than
 * the file has room for. */
static skinslide_status check_chunks(exr_const_context_t file, int part, const source *from, skinslide_error *error) {
    int32_t count = 0;
    uint64_t unpacked = 0;
    if (exr_get_chunk_count(file, part, &count) != EXR_ERR_SUCCESS || count < 1 ||
        exr_get_chunk_unpacked_size(file, part, &unpacked) != EXR_ERR_SUCCESS)
        return refuse_storage(error);
    if (count > from->size / 16)
        return ss_fail(error, SKINSLIDE_BAD_IMAGE,
                       "truncated: the header promises %d chunks of texels, the file has %lld bytes", count,
                       (long long)from->size);
    skinslide_status status = ss_check_most("", (uint64_t)count, "chunks of texels", MOST_CHUNKS, SKINSLIDE_UNSUPPORTED, error);
    return status ? status : ss_check_most("chunks of ", unpacked, "bytes", LARGEST_CHUNK, SKINSLIDE_UNSUPPORTED, error);
}

static skinslide_wrap wrap_word(const char *word, size_t length) {
    static const struct {
        const char *word;
        skinslide_wrap wrap;
    } known[] = {{"periodic", SKINSLIDE_WRAP_PERIODIC}, {"mirror", SKINSLIDE_WRAP_MIRROR}, {"black", SKINSLIDE_WRAP_BLACK}};
    while (length && *word == ' ')
        word++, length--;
    while (length && word[length - 1] == ' ')
        length--;
    for (size_t k = 0; k < sizeof known / sizeof *known; k++)
        if (strlen(known[k].word) == length && strncmp(word, known[k].word, length) == 0)
            return known[k].wrap;
    return SKINSLIDE_WRAP_CLAMP;
}

/* "periodic", or "periodic,clamp" for width and height. */
static void read_wraps(exr_const_context_t file, int part, skinslide_image *image) {
    int32_t length = 0;
    const char *text = NULL;
    if (exr_attr_get_string(file, part, "wrapmodes", &length, &text) != EXR_ERR_SUCCESS || !text || length < 0)
        return;
    const char *comma = memchr(text, ',', (size_t)length), *end = text + length;
    image->wrap_s = wrap_word(text, (size_t)((comma ? comma : end) - text));
    image->wrap_t = comma ? wrap_word(comma + 1, (size_t)(end - comma - 1)) : image->wrap_s;
}

/* ---- Texels ---- */

/* Where the texels of chunks are written: to those of the display window. */
typedef struct target {
    window data, display;
    float *pixels; /* of the display window */
    const selection *chosen;
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
    const window *display = &to->display;
    if (y < display->y || y >= display->y + display->height)
        return;
    int64_t begin = x > display->x ? x : display->x;
    int64_t end = x + width < display->x + display->width ? x + width : display->x + display->width;
    float *row = to->pixels + (y - display->y) * display->width;
    for (int64_t column = begin; column < end; column++)
        row[column - display->x] = texel(bytes + (column - x) * (is_half ? 2 : 4), is_half);
}

/* A decompressed chunk holds row after row; a row holds the texels of channel after channel, in the file's order. A channel of
 * fewer texels than the image has them on some rows only. False where the bytes are too few: OpenEXR takes what is not compressed
 * as it comes. It would unpack by itself, but 3.1.5 takes routines for it that write through the null pointers of channels that are
 * not wanted. */
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
            if (c == to->chosen->channel)
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
    int part = to->chosen->part;
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
           chunk->unpacked_size <= LARGEST_CHUNK && chunk->packed_size <= chunk->unpacked_size &&
           (packed ? chunk->packed_size > 0 : chunk->packed_size == chunk->unpacked_size) && chunk->data_offset <= size &&
           chunk->packed_size <= size - chunk->data_offset;
}

/* Returns the first row that cannot be decoded, or a row beyond the last. */
static int64_t decode_scanlines(exr_const_context_t file, int32_t lines, const target *to) {
    int64_t y = to->data.y, end = to->data.y + to->data.height;
    for (exr_chunk_info_t chunk; y < end; y += lines)
        if (!succeeds(to->from, exr_read_scanline_chunk_info(file, to->chosen->part, (int)y, &chunk)) ||
            !chunk_fits(&chunk, to) || chunk.width != to->data.width || !decode_chunk(file, &chunk, to, to->data.x, y))
            break;
    return y;
}

static int64_t decode_tiles(exr_const_context_t file, int32_t width, int32_t height, const target *to) {
    int64_t y = to->data.y, end = to->data.y + to->data.height;
    for (int row = 0; y < end; row++, y += height)
        for (int column = 0; (int64_t)column * width < to->data.width; column++) {
            exr_chunk_info_t chunk;
            if (!succeeds(to->from, exr_read_tile_chunk_info(file, to->chosen->part, column, row, 0, 0, &chunk)) ||
                !chunk_fits(&chunk, to) || !decode_chunk(file, &chunk, to, to->data.x + (int64_t)column * width, y))
                return y;
        }
    return y;
}

static int64_t least(int64_t a, int64_t b) {
    return a < b ? a : b;
}

static skinslide_status decode_texels(exr_const_context_t file, target *to, skinslide_error *error) {
    int32_t width = (int32_t)to->data.width, height = 0;
    exr_storage_t storage;
    int part = to->chosen->part;
    bool known = exr_get_storage(file, part, &storage) == EXR_ERR_SUCCESS;
    if (known && storage == EXR_STORAGE_TILED)
        known = exr_get_tile_sizes(file, part, 0, 0, &width, &height) == EXR_ERR_SUCCESS;
    else if (known)
        known = exr_get_scanlines_per_chunk(file, part, &height) == EXR_ERR_SUCCESS;
    if (!known || width < 1 || height < 1)
        return refuse_storage(error);
    to->chunk_size = least(width, to->data.width) * least(height, to->data.height);
    to->from->said[0] = 0;
    int64_t end = storage == EXR_STORAGE_TILED ? decode_tiles(file, width, height, to) : decode_scanlines(file, height, to);
    if (to->from->out_of_memory)
        return ss_out_of_memory(error);
    if (end < to->data.y + to->data.height)
        return ss_fail(error, SKINSLIDE_BAD_IMAGE, "truncated or corrupt: row %lld of %lld cannot be decoded%s%s",
                       (long long)(end - to->data.y), (long long)to->data.height, to->from->said[0] ? ": " : "",
                       to->from->said);
    return SKINSLIDE_OK;
}

/* ---- Decoding ---- */

static char *copy_name(ss_memory *memory, exr_const_context_t file, const selection *chosen) {
    const char *name = chosen->channels->entries[chosen->channel].name.str;
    const char *part = chosen->part_count > 1 ? part_name(file, chosen->part) : "";
    size_t size = strlen(part) + 1 + strlen(name) + 1;
    char *copy = SS_NEW(memory, char, (int64_t)size);
    if (copy)
        snprintf(copy, size, "%s%s%s", part, part[0] ? "." : "", name);
    return copy;
}

static skinslide_status decode_selection(exr_const_context_t file, const selection *chosen, source *from, skinslide_image **out,
                                         skinslide_error *error) {
    target to = {.chosen = chosen, .from = from};
    skinslide_status status = check_channel(chosen, error);
    if (!status)
        status = check_compression(file, chosen, error);
    if (!status)
        status = read_windows(file, chosen->part, &to.data, &to.display, error);
    if (!status)
        status = check_chunks(file, chosen->part, from, error);
    if (status)
        return status;
    ss_memory memory = {0};
    owned_image *owned = SS_NEW(&memory, owned_image, 1);
    to.pixels = SS_NEW(&memory, float, to.display.width *to.display.height);
    char *name = copy_name(&memory, file, chosen);
    status = memory.failed ? ss_out_of_memory(error) : decode_texels(file, &to, error);
    if (status) {
        ss_free(&memory);
        return status;
    }
    owned->memory = memory;
    owned->image = (skinslide_image){.size = sizeof owned->image,
                                     .width = (int32_t)to.display.width,
                                     .height = (int32_t)to.display.height,
                                     .pixels = to.pixels,
                                     .channel = name};
    read_wraps(file, chosen->part, &owned->image);
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
    selection chosen = {.channel = -1};
    skinslide_status status;
    if (from->out_of_memory)
        status = ss_out_of_memory(error);
    else if (!opened)
        status = ss_fail(error, SKINSLIDE_BAD_IMAGE, "not an OpenEXR file, or a truncated or corrupt one%s%s",
                         from->said[0] ? ": " : "", from->said);
    else
        status = choose_channel(file, channel ? channel : "", &chosen, error);
    if (!status)
        status = decode_selection(file, &chosen, from, out, error);
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
