/* Reads the header of an OpenEXR file: which channel is meant, and how its texels are stored. Headers are untrusted: what they
 * claim is held against limits and against the size of the file before memory is taken. */
#include "paint.h"

#include <openexr.h>
#include <stdio.h>
#include <string.h>

enum { MOST_CHUNKS = 1 << 22 };

/* One channel of one part that is not deep. */
typedef struct selection {
    int part, part_count;
    const exr_attr_chlist_t *channels;
    int32_t channel; /* -1: none */
} selection;

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

static ss_exr_window window_of(exr_attr_box2i_t box) {
    return (ss_exr_window){box.min.x, box.min.y, (int64_t)box.max.x - box.min.x + 1, (int64_t)box.max.y - box.min.y + 1};
}

static skinslide_status check_window(const char *what, ss_exr_window w, skinslide_error *error) {
    if (w.width < 1 || w.height < 1)
        return ss_fail(error, SKINSLIDE_BAD_IMAGE, "the %s window has no texels (%lld x %lld)", what, (long long)w.width,
                       (long long)w.height);
    if (w.width > SS_LARGEST_IMAGE * (int64_t)SS_LARGEST_IMAGE || w.height > SS_LARGEST_IMAGE * (int64_t)SS_LARGEST_IMAGE ||
        w.width * w.height > SS_LARGEST_IMAGE * (int64_t)SS_LARGEST_IMAGE)
        return ss_fail(error, SKINSLIDE_UNSUPPORTED, "the %s window is %lld x %lld; more texels than %d x %d are refused", what,
                       (long long)w.width, (long long)w.height, SS_LARGEST_IMAGE, SS_LARGEST_IMAGE);
    return SKINSLIDE_OK;
}

static skinslide_status read_windows(exr_const_context_t file, ss_exr_header *out, skinslide_error *error) {
    exr_attr_box2i_t data_box, display_box;
    if (exr_get_data_window(file, out->part, &data_box) != EXR_ERR_SUCCESS ||
        exr_get_display_window(file, out->part, &display_box) != EXR_ERR_SUCCESS)
        return ss_fail(error, SKINSLIDE_BAD_IMAGE, "the header has no data window or no display window");
    out->data = window_of(data_box), out->display = window_of(display_box);
    skinslide_status status = check_window("data", out->data, error);
    return status ? status : check_window("display", out->display, error);
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
static skinslide_status check_chunks(exr_const_context_t file, int part, int64_t file_size, skinslide_error *error) {
    int32_t count = 0;
    uint64_t unpacked = 0;
    if (exr_get_chunk_count(file, part, &count) != EXR_ERR_SUCCESS || count < 1 ||
        exr_get_chunk_unpacked_size(file, part, &unpacked) != EXR_ERR_SUCCESS)
        return refuse_storage(error);
    if (count > file_size / 16)
        return ss_fail(error, SKINSLIDE_BAD_IMAGE,
                       "truncated: the header promises %d chunks of texels, the file has %lld bytes", count,
                       (long long)file_size);
    skinslide_status status = ss_check_most("", (uint64_t)count, "chunks of texels", MOST_CHUNKS, SKINSLIDE_UNSUPPORTED, error);
    return status ? status : ss_check_most("chunks of ", unpacked, "bytes", SS_LARGEST_CHUNK, SKINSLIDE_UNSUPPORTED, error);
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

/* How texels are stored: in tiles, or in chunks of scanlines. */
static skinslide_status read_storage(exr_const_context_t file, ss_exr_header *out, skinslide_error *error) {
    exr_storage_t storage;
    bool known = exr_get_storage(file, out->part, &storage) == EXR_ERR_SUCCESS;
    out->tiled = known && storage == EXR_STORAGE_TILED;
    out->chunk_width = (int32_t)out->data.width;
    if (out->tiled)
        known = exr_get_tile_sizes(file, out->part, 0, 0, &out->chunk_width, &out->chunk_height) == EXR_ERR_SUCCESS;
    else if (known)
        known = exr_get_scanlines_per_chunk(file, out->part, &out->chunk_height) == EXR_ERR_SUCCESS;
    return known && out->chunk_width > 0 && out->chunk_height > 0 ? SKINSLIDE_OK : refuse_storage(error);
}

/* "periodic", or "periodic,clamp" for width and height. */
static void read_wraps(exr_const_context_t file, ss_exr_header *out) {
    int32_t length = 0;
    const char *text = NULL;
    if (exr_attr_get_string(file, out->part, "wrapmodes", &length, &text) != EXR_ERR_SUCCESS || !text || length < 0)
        return;
    const char *comma = memchr(text, ',', (size_t)length), *end = text + length;
    out->wrap_s = wrap_word(text, (size_t)((comma ? comma : end) - text));
    out->wrap_t = comma ? wrap_word(comma + 1, (size_t)(end - comma - 1)) : out->wrap_s;
}

skinslide_status ss_exr_read_header(const void *file, const char *wanted, int64_t file_size, ss_exr_header *out,
                                    skinslide_error *error) {
    selection chosen = {.channel = -1};
    skinslide_status status = choose_channel(file, wanted, &chosen, error);
    if (!status)
        status = check_channel(&chosen, error);
    if (!status)
        status = check_compression(file, &chosen, error);
    if (status)
        return status;
    *out = (ss_exr_header){.part = chosen.part,
                           .channel = chosen.channel,
                           .part_name = chosen.part_count > 1 ? part_name(file, chosen.part) : "",
                           .channel_name = chosen.channels->entries[chosen.channel].name.str};
    status = read_windows(file, out, error);
    if (!status)
        status = check_chunks(file, out->part, file_size, error);
    if (!status)
        status = read_storage(file, out, error);
    read_wraps(file, out);
    return status;
}
