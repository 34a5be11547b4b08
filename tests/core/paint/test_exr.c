/* OpenEXR files in and out of memory: every kind against the texels it was made of, and every bad one refused. */
#define _XOPEN_SOURCE 700 /* ftruncate, getrusage */
#include "exrfiles.h"
#include "skinslide/paint.h"
#include "support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

static skinslide_error error;

enum { BEFORE = 7 }; /* bytes of something else, in front of a file that lies in another */

/* Reads the file from one that is open, in which it is followed by zeros up to a size. */
static skinslide_status read_open(exr_file file, int64_t size, const char *channel, skinslide_image **image,
                                  skinslide_error *said) {
    FILE *open = tmpfile();
    assert_non_null(open);
    assert_int_equal(fwrite("before", 1, BEFORE, open), BEFORE);
    if (file.size > 0)
        assert_int_equal(fwrite(file.bytes, 1, (size_t)file.size, open), (size_t)file.size);
    assert_int_equal(fflush(open), 0);
    if (size > file.size)
        assert_int_equal(ftruncate(fileno(open), (off_t)(BEFORE + size)), 0);
    skinslide_status status = skinslide_exr_read(fileno(open), BEFORE, size, channel, image, said);
    assert_int_equal(lseek(fileno(open), 0, SEEK_CUR), BEFORE + file.size);
    fclose(open);
    return status;
}

static skinslide_image *read_channel(exr_file file, const char *channel) {
    skinslide_image *image = NULL, *same = NULL;
    assert_ok(skinslide_exr_decode(file.bytes, file.size, channel, &image, &error), &error);
    assert_ok(read_open(file, file.size, channel, &same, &error), &error);
    assert_int_equal(same->width, image->width);
    assert_int_equal(same->height, image->height);
    assert_same_bytes(same->pixels, image->pixels, (size_t)image->width * (size_t)image->height * sizeof *image->pixels);
    skinslide_image_destroy(same);
    return image;
}

static skinslide_status status_of(exr_file file, const char *channel) {
    skinslide_image *image = NULL, *same = NULL;
    skinslide_error other;
    skinslide_status status = skinslide_exr_decode(file.bytes, file.size, channel, &image, &error);
    assert_int_equal(image == NULL, status != SKINSLIDE_OK);
    assert_int_equal(read_open(file, file.size, channel, &same, &other), status);
    if (status)
        assert_string_equal(other.message, error.message);
    skinslide_image_destroy(image);
    skinslide_image_destroy(same);
    return status;
}

/* Texels of the data window are those written; others of the display window are 0. */
static void assert_texels(const skinslide_image *image, const exr_part *part, int32_t channel) {
    const int32_t *data = part->data;
    bool whole = !data[0] && !data[1] && !data[2] && !data[3];
    assert_int_equal(image->width, part->width);
    assert_int_equal(image->height, part->height);
    for (int32_t y = 0; y < part->height; y++)
        for (int32_t x = 0; x < part->width; x++) {
            bool inside = whole || (x >= data[0] && x <= data[2] && y >= data[1] && y <= data[3]);
            assert_near(image->pixels[y * part->width + x], inside ? exr_value(x, y, channel) : 0, 0);
        }
}

static void assert_reads(exr_part part) {
    exr_file file = write_exr(&part, 1);
    for (int32_t c = 0; c < 8 && part.channels[c]; c++) {
        skinslide_image *image = read_channel(file, part.channels[c]);
        assert_texels(image, &part, c);
        assert_string_equal(image->channel, part.channels[c]);
        skinslide_image_destroy(image);
    }
    free(file.bytes);
}

static const exr_part plain = {.channels = {"A", "B", "G", "R"}, .width = 21, .height = 37, .type = EXR_PIXEL_FLOAT, .tile = 8};

static void every_storage_compression_and_type(void **state) {
    (void)state;
    static const exr_compression_t compressions[] = {EXR_COMPRESSION_NONE, EXR_COMPRESSION_RLE, EXR_COMPRESSION_ZIPS,
                                                     EXR_COMPRESSION_ZIP,  EXR_COMPRESSION_PIZ, EXR_COMPRESSION_PXR24};
    for (int i = 0; i < 24; i++) {
        exr_part part = plain;
        part.compression = compressions[i / 4];
        part.storage = i & 1 ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE;
        part.type = i & 2 ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;
        assert_reads(part); /* PXR24 keeps 24 bits of a float, and the values need fewer */
    }
}

static void every_number_of_channels(void **state) {
    (void)state;
    static const char *const names[] = {"a", "b", "c", "d", "e", "f", "g"};
    for (int count = 1; count <= 7; count++) {
        exr_part part = plain;
        memset(part.channels, 0, sizeof part.channels);
        memcpy(part.channels, names, (size_t)count * sizeof *names);
        part.compression = EXR_COMPRESSION_ZIP;
        assert_reads(part);
        part.type = EXR_PIXEL_HALF;
        assert_reads(part);
    }
}

static void windows(void **state) {
    (void)state;
    static const int32_t data[5][4] = {
        {3, 5, 12, 20}, {-4, -6, 30, 50}, {10, -3, 40, 8}, {-20, 30, 0, 60}, {100, 100, 110, 120}};
    for (int i = 0; i < 10; i++) {
        exr_part part = plain;
        memcpy(part.data, data[i / 2], sizeof part.data);
        part.storage = i & 1 ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE;
        part.compression = EXR_COMPRESSION_ZIP;
        assert_reads(part);
    }
}

static void the_largest_level_of_mip_maps(void **state) {
    (void)state;
    exr_part part = plain;
    part.storage = EXR_STORAGE_TILED, part.levels = true;
    assert_reads(part);
}

/* Every half, against IEEE 754's own reading: (-1)^s 2^(e-15) (1 + f/1024), 2^-14 f/1024 where e is 0. */
static void every_half(void **state) {
    (void)state;
    uint16_t *halves = malloc(65536 * sizeof *halves);
    for (int i = 0; i < 65536; i++)
        halves[i] = (uint16_t)i;
    exr_part part = {.channels = {"Y"}, .width = 256, .height = 256, .type = EXR_PIXEL_HALF, .halves = halves};
    exr_file file = write_exr(&part, 1);
    skinslide_image *image = read_channel(file, "");
    for (int i = 0; i < 65536; i++) {
        int exponent = i >> 10 & 31, fraction = i & 1023;
        double size = exponent ? pow(2, exponent - 15) * (1 + fraction / 1024.0) : pow(2, -14) * (fraction / 1024.0);
        if (exponent == 31)
            assert_true(fraction ? isnan(image->pixels[i]) : isinf(image->pixels[i]));
        else
            assert_near(fabs(image->pixels[i]), size, 0);
        assert_true((exponent == 31 && fraction) || !signbit(image->pixels[i]) == !(i & 0x8000));
    }
    skinslide_image_destroy(image);
    free(file.bytes);
    free(halves);
}

static void assert_chosen(const exr_part *parts, int count, const char *wanted, const char *chosen, int32_t part,
                          int32_t channel) {
    exr_file file = write_exr(parts, count);
    skinslide_image *image = read_channel(file, wanted);
    assert_string_equal(image->channel, chosen);
    assert_texels(image, &parts[part], channel);
    skinslide_image_destroy(image);
    free(file.bytes);
}

static void channels_are_chosen(void **state) {
    (void)state;
    exr_part part = plain;
    assert_chosen(&part, 1, NULL, "R", 0, 3);
    assert_chosen(&part, 1, "", "R", 0, 3);
    assert_chosen(&part, 1, "B", "B", 0, 1);
    exr_part grey = {.channels = {"A", "X", "Y"}, .width = 5, .height = 4, .type = EXR_PIXEL_HALF};
    assert_chosen(&grey, 1, "", "Y", 0, 2);
    exr_part mask = {.channels = {"A", "mask"}, .width = 5, .height = 4, .type = EXR_PIXEL_HALF};
    assert_chosen(&mask, 1, "", "mask", 0, 1);
    exr_part alpha = {.channels = {"A"}, .width = 5, .height = 4, .type = EXR_PIXEL_HALF};
    assert_chosen(&alpha, 1, "", "A", 0, 0);
    exr_part layer = {.channels = {"paint.R", "paint.G"}, .width = 5, .height = 4, .type = EXR_PIXEL_HALF};
    assert_chosen(&layer, 1, "paint.R", "paint.R", 0, 0);
    exr_part one = {.channels = {"paint.A", "paint.B", "paint.G", "paint.R"}, .width = 5, .height = 4, .type = EXR_PIXEL_HALF};
    assert_chosen(&one, 1, "", "paint.R", 0, 3);
    exr_part nested = {.channels = {"a.b.A", "a.b.Y"}, .width = 5, .height = 4, .type = EXR_PIXEL_HALF};
    assert_chosen(&nested, 1, "", "a.b.Y", 0, 1);
    exr_part masks = {.channels = {"paint.A", "paint.mask"}, .width = 5, .height = 4, .type = EXR_PIXEL_HALF};
    assert_chosen(&masks, 1, "", "paint.mask", 0, 1);
    exr_part several = {.channels = {"a.G", "a.R", "b.R"}, .width = 5, .height = 4, .type = EXR_PIXEL_HALF};
    assert_chosen(&several, 1, "", "a.G", 0, 0);
    exr_part beside = {.channels = {"R", "paint.R"}, .width = 5, .height = 4, .type = EXR_PIXEL_HALF};
    assert_chosen(&beside, 1, "", "R", 0, 0);
}

static void parts_are_chosen(void **state) {
    (void)state;
    exr_part parts[] = {{.name = "left", .channels = {"R", "G"}, .width = 6, .height = 5, .type = EXR_PIXEL_HALF},
                        {.name = "right",
                         .channels = {"G", "Z"},
                         .type = EXR_PIXEL_FLOAT,
                         .width = 9,
                         .height = 8,
                         .storage = EXR_STORAGE_TILED,
                         .tile = 4}};
    assert_chosen(parts, 2, "", "left.R", 0, 0);
    assert_chosen(parts, 2, "G", "left.G", 0, 1);
    assert_chosen(parts, 2, "right.G", "right.G", 1, 0);
    assert_chosen(parts, 2, "Z", "right.Z", 1, 1);
    exr_file file = write_exr(parts, 2);
    assert_fails(status_of(file, "A"), &error, SKINSLIDE_BAD_IMAGE,
                 "there is no channel A; the file has left.G, left.R, right.G, right.Z");
    free(file.bytes);
}

static void wraps_are_read(void **state) {
    (void)state;
    static const struct {
        const char *text;
        skinslide_wrap s, t;
    } cases[] = {{NULL, SKINSLIDE_WRAP_CLAMP, SKINSLIDE_WRAP_CLAMP},
                 {"periodic", SKINSLIDE_WRAP_PERIODIC, SKINSLIDE_WRAP_PERIODIC},
                 {"black,clamp", SKINSLIDE_WRAP_BLACK, SKINSLIDE_WRAP_CLAMP},
                 {" mirror , periodic ", SKINSLIDE_WRAP_MIRROR, SKINSLIDE_WRAP_PERIODIC},
                 {"default,", SKINSLIDE_WRAP_CLAMP, SKINSLIDE_WRAP_CLAMP},
                 {"", SKINSLIDE_WRAP_CLAMP, SKINSLIDE_WRAP_CLAMP}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        exr_part part = plain;
        part.wrapmodes = cases[i].text;
        exr_file file = write_exr(&part, 1);
        skinslide_image *image = read_channel(file, "");
        assert_int_equal(image->wrap_s, cases[i].s);
        assert_int_equal(image->wrap_t, cases[i].t);
        skinslide_image_destroy(image);
        free(file.bytes);
    }
}

/* ---- Refused ---- */

static void assert_refused(exr_part part, const char *channel, skinslide_status expected, const char *text) {
    exr_file file = write_exr(&part, 1);
    assert_fails(status_of(file, channel), &error, expected, text);
    free(file.bytes);
}

static void kinds_that_are_no_map(void **state) {
    (void)state;
    exr_part part = plain;
    part.type = EXR_PIXEL_UINT;
    assert_refused(part, "", SKINSLIDE_UNSUPPORTED, "channel R holds whole numbers (uint); it must be half or float");
    part = plain, part.sampling = 2, part.width = 20, part.height = 36;
    assert_refused(part, "R", SKINSLIDE_UNSUPPORTED, "channel R has fewer texels than the image (sampling 2, 2)");
    part.compression = EXR_COMPRESSION_ZIP;
    exr_file file = write_exr(&part, 1); /* beside which others can be read */
    skinslide_image *image = read_channel(file, "G");
    assert_texels(image, &part, 2);
    skinslide_image_destroy(image);
    free(file.bytes);
    part = plain, part.compression = EXR_COMPRESSION_B44;
    assert_refused(part, "", SKINSLIDE_UNSUPPORTED, "compression B44 is not read; write the file as ZIP or PIZ");
    part = plain, part.storage = EXR_STORAGE_DEEP_SCANLINE, part.name = "deep";
    assert_refused(part, "", SKINSLIDE_BAD_IMAGE, "the image is deep; flatten it");
    part.storage = EXR_STORAGE_DEEP_TILED;
    assert_refused(part, "R", SKINSLIDE_BAD_IMAGE, "the image is deep; flatten it");
    assert_refused(plain, "Q", SKINSLIDE_BAD_IMAGE, "there is no channel Q; the file has A, B, G, R");
    assert_refused(plain, "a\nb", SKINSLIDE_BAD_IMAGE, "there is no channel a\\nb; the file has A, B, G, R");
}

/* Returns where an attribute's value begins: after its name, type and size. */
static uint8_t *attribute(exr_file file, const char *name, const char *type) {
    size_t name_size = strlen(name) + 1, type_size = strlen(type) + 1;
    for (uint8_t *at = file.bytes; at < file.bytes + file.size - name_size - type_size; at++)
        if (memcmp(at, name, name_size) == 0 && memcmp(at + name_size, type, type_size) == 0)
            return at + name_size + type_size + 4;
    fail_msg("no attribute %s", name);
    return NULL;
}

static void assert_window_refused(const char *name, const int32_t box[4], skinslide_status expected, const char *text) {
    exr_part part = plain;
    exr_file file = write_exr(&part, 1);
    memcpy(attribute(file, name, "box2i"), box, 16);
    assert_fails(status_of(file, ""), &error, expected, text);
    free(file.bytes);
}

/* Windows of no texels and of very many, in a file of few bytes: refused without taking memory for them. */
static void windows_that_cannot_be(void **state) {
    (void)state;
    assert_window_refused("dataWindow", (int32_t[4]){0, 0, -1, -1}, SKINSLIDE_BAD_IMAGE,
                          "not an OpenEXR file, or a truncated or corrupt one: Invalid data window (0, 0 - -1, -1)");
    assert_window_refused("displayWindow", (int32_t[4]){0, 0, -1, -1}, SKINSLIDE_BAD_IMAGE,
                          "not an OpenEXR file, or a truncated or corrupt one: Invalid display window (0, 0 - -1, -1)");
    assert_window_refused("displayWindow", (int32_t[4]){0, 0, 16384, 16383}, SKINSLIDE_UNSUPPORTED,
                          "the display window is 16385 x 16384; more texels than 16384 x 16384 are refused");
    assert_window_refused("displayWindow", (int32_t[4]){-2147483647, -2147483647, 2147483647, 2147483647}, SKINSLIDE_BAD_IMAGE,
                          "not an OpenEXR file, or a truncated or corrupt one: Invalid display window...");
    assert_window_refused("dataWindow", (int32_t[4]){0, 0, 99999, 99999}, SKINSLIDE_UNSUPPORTED,
                          "the data window is 100000 x 100000; more texels...");
    assert_window_refused("dataWindow", (int32_t[4]){0, 0, 20, 99999}, SKINSLIDE_BAD_IMAGE,
                          "truncated: the header promises 100000 chunks of texels, the file has 13384 bytes");
    assert_window_refused("dataWindow", (int32_t[4]){0, 0, 9999, 36}, SKINSLIDE_BAD_IMAGE,
                          "truncated or corrupt: row 0 of 37 cannot be decoded...");
}

/* A file of 4 GB without a block on the disk, of which only the header is read. */
static void assert_large_refused(const int32_t box[4], skinslide_status expected, const char *text) {
    exr_part part = plain;
    exr_file file = write_exr(&part, 1);
    skinslide_image *image = NULL;
    memcpy(attribute(file, "dataWindow", "box2i"), box, 16);
    memcpy(attribute(file, "displayWindow", "box2i"), box, 16);
    memset(file.bytes + file.size - 21 * 37 * 16, 0, 21 * 37 * 16);
    assert_fails(read_open(file, (int64_t)4 << 30, "", &image, &error), &error, expected, text);
    assert_null(image);
    free(file.bytes);
}

static void large_files_of_nothing(void **state) {
    (void)state;
    struct rusage before, after;
    getrusage(RUSAGE_SELF, &before);
    assert_large_refused((int32_t[4]){0, 0, 16383, 16383}, SKINSLIDE_BAD_IMAGE, "truncated or corrupt: row 0 of 16384...");
    assert_large_refused((int32_t[4]){0, 0, 0, (1 << 28) - 1}, SKINSLIDE_UNSUPPORTED,
                         "268435456 chunks of texels; more than 4194304 are refused");
    getrusage(RUSAGE_SELF, &after);
    assert_true(after.ru_maxrss - before.ru_maxrss <
                512 << 10); /* kilobytes; AddressSanitizer notes an eighth of what is freed */
}

/* An attribute that claims to be longer than a header may be. */
static void a_header_that_does_not_end(void **state) {
    (void)state;
    exr_part part = plain;
    skinslide_image *image = NULL;
    part.wrapmodes = "black";
    exr_file file = write_exr(&part, 1);
    const int32_t size = 1 << 27;
    memcpy(attribute(file, "wrapmodes", "string") - 4, &size, sizeof size);
    assert_fails(read_open(file, (int64_t)3 << 30, "", &image, &error), &error, SKINSLIDE_BAD_IMAGE,
                 "not an OpenEXR file, or a truncated or corrupt one...");
    free(file.bytes);
}

/* Cut anywhere, a file is refused; the message says so. */
static void assert_needs_every_byte(exr_part part) {
    exr_file file = write_exr(&part, 1);
    for (int64_t size = 0; size < file.size; size++) {
        uint8_t *copy = malloc((size_t)size + 1); /* of its own, so that a sanitizer sees every byte read too many */
        memcpy(copy, file.bytes, (size_t)size);
        assert_int_equal(status_of((exr_file){copy, size}, ""), SKINSLIDE_BAD_IMAGE);
        assert_non_null(strstr(error.message, "truncated"));
        free(copy);
    }
    free(file.bytes);
}

static void truncated_files(void **state) {
    (void)state;
    exr_part part = plain;
    part.width = 9, part.height = 17;
    assert_needs_every_byte(part);
    part.compression = EXR_COMPRESSION_ZIP;
    assert_needs_every_byte(part);
    part.storage = EXR_STORAGE_TILED;
    assert_needs_every_byte(part);
    part.compression = EXR_COMPRESSION_NONE;
    assert_needs_every_byte(part);
    assert_fails(status_of((exr_file){0}, ""), &error, SKINSLIDE_BAD_IMAGE,
                 "not an OpenEXR file, or a truncated or corrupt one...");
}

static void bad_arguments(void **state) {
    (void)state;
    skinslide_image *image = NULL;
    uint8_t byte = 0;
    assert_int_equal(skinslide_exr_decode(NULL, 5, "", &image, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_exr_decode(&byte, -1, "", &image, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_exr_decode(&byte, 1, "", NULL, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_exr_decode(&byte, 1, NULL, &image, NULL), SKINSLIDE_BAD_IMAGE);
    assert_int_equal(skinslide_exr_read(0, -1, 1, "", &image, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_exr_read(0, 1, INT64_MAX, "", &image, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_exr_read(0, 0, 1, "", NULL, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_exr_read(-1, 0, 1, "", &image, &error), SKINSLIDE_BAD_IMAGE);
    skinslide_image_destroy(NULL);
    skinslide_bytes_destroy(NULL);
}

/* ---- Written ---- */

static void what_is_written_is_read_back(void **state) {
    (void)state;
    enum { WIDTH = 33, HEIGHT = 50 };
    float a[WIDTH * HEIGHT], b[WIDTH * HEIGHT];
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        a[i] = (float)sin(i), b[i] = i % 7 ? (float)i * 1e30f : INFINITY;
    const skinslide_channel channels[] = {{sizeof(skinslide_channel), "stretch", a}, {sizeof(skinslide_channel), "R", b}};
    skinslide_bytes *made = NULL, *again = NULL;
    for (skinslide_wrap wrap = SKINSLIDE_WRAP_CLAMP; wrap <= SKINSLIDE_WRAP_BLACK; wrap++) {
        assert_ok(skinslide_exr_encode(channels, 2, WIDTH, HEIGHT, wrap, &made, &error), &error);
        assert_ok(skinslide_exr_encode(channels, 2, WIDTH, HEIGHT, wrap, &again, &error), &error);
        assert_int_equal(made->size, again->size);
        assert_same_bytes(made->data, again->data, (size_t)made->size);
        for (int c = 0; c < 2; c++) {
            skinslide_image *image = NULL;
            assert_ok(skinslide_exr_decode(made->data, made->size, channels[c].name, &image, &error), &error);
            assert_same_bytes(image->pixels, channels[c].pixels, sizeof a);
            assert_int_equal(image->wrap_s, wrap);
            assert_int_equal(image->wrap_t, wrap);
            skinslide_image_destroy(image);
        }
        skinslide_bytes_destroy(made);
        skinslide_bytes_destroy(again);
    }
}

/* Small and plain images: those that compress to just as many bytes as they had are among them. */
static void small_images_are_read_back(void **state) {
    (void)state;
    static const float values[] = {0, 1, NAN, 0.1f, -2e30f};
    for (int32_t i = 0; i < 8 * 8 * 5 * 3; i++) {
        int32_t width = 1 + i % 8, height = 1 + i / 8 % 8, kind = i / 64 % 5, step = i / 320;
        float pixels[64];
        for (int32_t k = 0; k < width * height; k++)
            pixels[k] = values[(kind + k * step) % 5];
        const skinslide_channel channel = {sizeof(skinslide_channel), "R", pixels};
        skinslide_bytes *made = NULL;
        skinslide_image *image = NULL;
        assert_ok(skinslide_exr_encode(&channel, 1, width, height, SKINSLIDE_WRAP_CLAMP, &made, &error), &error);
        assert_ok(skinslide_exr_decode(made->data, made->size, NULL, &image, &error), &error);
        assert_same_bytes(image->pixels, pixels, (size_t)(width * height) * sizeof *pixels);
        skinslide_image_destroy(image);
        skinslide_bytes_destroy(made);
    }
}

static void what_cannot_be_written(void **state) {
    (void)state;
    float pixel = 1;
    skinslide_bytes *made = NULL;
    const skinslide_channel good = {sizeof(skinslide_channel), "R", &pixel}, unnamed = {sizeof(skinslide_channel), "", &pixel},
                            empty = {sizeof(skinslide_channel), "R", NULL};
    const skinslide_channel twice[] = {{sizeof(skinslide_channel), "R", &pixel}, {sizeof(skinslide_channel), "R", &pixel}},
                            named = {sizeof(skinslide_channel), "a name of two and thirty letters!", &pixel};
    assert_fails(skinslide_exr_encode(&good, 0, 1, 1, 0, &made, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "no channels to write");
    assert_fails(skinslide_exr_encode(&good, 1, 0, 1, 0, &made, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "an image of 0 x 1; each must be 1 to 16384");
    assert_int_equal(skinslide_exr_encode(&good, 1, 1, 16385, 0, &made, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_exr_encode(&good, 1, 1, 1, 9, &made, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_exr_encode(&unnamed, 1, 1, 1, 0, &made, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_exr_encode(&named, 1, 1, 1, 0, &made, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_int_equal(skinslide_exr_encode(&empty, 1, 1, 1, 0, &made, &error), SKINSLIDE_BAD_ARGUMENT);
    assert_fails(skinslide_exr_encode(twice, 2, 1, 1, 0, &made, &error), &error, SKINSLIDE_BAD_ARGUMENT,
                 "channel R comes twice");
    assert_null(made);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_storage_compression_and_type),
        cmocka_unit_test(every_number_of_channels),
        cmocka_unit_test(windows),
        cmocka_unit_test(the_largest_level_of_mip_maps),
        cmocka_unit_test(every_half),
        cmocka_unit_test(channels_are_chosen),
        cmocka_unit_test(parts_are_chosen),
        cmocka_unit_test(wraps_are_read),
        cmocka_unit_test(kinds_that_are_no_map),
        cmocka_unit_test(windows_that_cannot_be),
        cmocka_unit_test(large_files_of_nothing),
        cmocka_unit_test(a_header_that_does_not_end),
        cmocka_unit_test(truncated_files),
        cmocka_unit_test(bad_arguments),
        cmocka_unit_test(what_is_written_is_read_back),
        cmocka_unit_test(small_images_are_read_back),
        cmocka_unit_test(what_cannot_be_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
