/* Damaged OpenEXR files of every kind: an image of finite size or a refusal, never a crash. Seeded, so every run is the same,
 * but for how far it comes in its time. */
#define _POSIX_C_SOURCE 199309L /* clock_gettime */
#include "exrfiles.h"
#include "skinslide/paint.h"
#include "support.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { SECONDS = 3, KINDS = 15 };

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static exr_file file_of_kind(int kind) {
    static const exr_compression_t compressions[] = {EXR_COMPRESSION_NONE, EXR_COMPRESSION_RLE, EXR_COMPRESSION_ZIP,
                                                     EXR_COMPRESSION_PIZ, EXR_COMPRESSION_PXR24};
    exr_part parts[2] = {{.name = "one",
                          .channels = {"A", "R", "x"},
                          .width = 19,
                          .height = 23,
                          .tile = 8,
                          .wrapmodes = "periodic,black",
                          .compression = compressions[kind % 5],
                          .storage = kind / 5 == 1 ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE,
                          .type = kind & 1 ? EXR_PIXEL_FLOAT : EXR_PIXEL_HALF}};
    parts[1] = parts[0];
    parts[1].name = "two";
    memcpy(parts[1].data, (int32_t[4]){-3, 4, 30, 15}, sizeof parts[1].data);
    return write_exr(parts, kind / 5 == 2 ? 2 : 1);
}

/* Changes bytes, or numbers of two or four bytes, copies runs, and cuts the end off. */
static void damage(exr_file *file, dice *d) {
    static const int32_t odd[] = {0, 1, -1, 2, 255, 65535, 16384, INT32_MAX, INT32_MIN, 0x7f800000};
    int32_t size = (int32_t)file->size, at = roll_below(d, roll_below(d, 2) ? size : size < 500 ? size : 500);
    int32_t value = roll_below(d, 2) ? odd[roll_below(d, 10)] : (int32_t)roll(d);
    int32_t room = size - at, length = roll_below(d, room < 40 ? room : 40);
    switch (roll_below(d, 8)) {
    case 0:
        file->size = at;
        break;
    case 1:
        memcpy(file->bytes + at, &value, room < 4 ? (size_t)room : 4);
        break;
    case 2:
        memmove(file->bytes + at, file->bytes + roll_below(d, size - length), (size_t)length);
        break;
    case 3:
        memset(file->bytes + at, value, (size_t)length);
        break;
    default:
        file->bytes[at] = (uint8_t)value;
    }
}

static void read_damaged(exr_file whole, dice *d) {
    exr_file copy = {malloc((size_t)whole.size), whole.size};
    memcpy(copy.bytes, whole.bytes, (size_t)whole.size);
    for (int32_t i = 1 + roll_below(d, 4); i > 0 && copy.size > 0; i--)
        damage(&copy, d);
    copy.bytes = realloc(copy.bytes, (size_t)copy.size + (copy.size == 0)); /* so that a sanitizer sees its end */
    static const char *const channels[] = {"", "R", "x", "two.R", "nothing"};
    skinslide_image *image = NULL;
    skinslide_error error = {0};
    skinslide_status status = skinslide_exr_decode(copy.bytes, copy.size, channels[roll_below(d, 5)], &image, &error);
    if (status) {
        assert_null(image);
        assert_true(error.message[0] != 0 && !strchr(error.message, '\n'));
        assert_true(status == SKINSLIDE_BAD_IMAGE || status == SKINSLIDE_UNSUPPORTED || status == SKINSLIDE_OUT_OF_MEMORY);
    } else {
        assert_true(image->width > 0 && image->height > 0 && (int64_t)image->width * image->height <= 16384 * 16384);
        double sum = image->pixels[0] + image->pixels[(int64_t)image->width * image->height - 1];
        assert_true(sum == sum || sum != sum); /* both ends can be read */
    }
    skinslide_image_destroy(image);
    free(copy.bytes);
}

static void damaged_files(void **state) {
    (void)state;
    exr_file files[KINDS];
    dice d = {7};
    for (int kind = 0; kind < KINDS; kind++)
        files[kind] = file_of_kind(kind);
    int rounds = 0;
    for (double end = now() + SECONDS; now() < end; rounds++)
        read_damaged(files[rounds % KINDS], &d);
    assert_true(rounds > 100 * KINDS);
    for (int kind = 0; kind < KINDS; kind++)
        free(files[kind].bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(damaged_files)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
