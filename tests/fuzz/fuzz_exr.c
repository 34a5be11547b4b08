/* A file of any bytes, as OpenEXR: an image whose texels can all be read, or a refusal in one line. The first byte chooses the
 * channel that is asked for. */
#include "skinslide/paint.h"
#include "stream.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const channels[] = {"", "R", "x", "two.R", "nothing"};
    stream s = {data, size};
    const char *channel = channels[take_below(&s, 5)];
    int64_t left = (int64_t)s.left;
    uint8_t *file = take_new(&s, s.left);
    skinslide_image *image = NULL;
    skinslide_error error;
    skinslide_status status = skinslide_exr_decode(file, left, channel, &image, &error);
    if (status)
        require(!image && error.message[0] && !strchr(error.message, '\n'));
    volatile float texel = 0;
    for (int64_t i = 0; !status && i < (int64_t)image->width * image->height; i++)
        texel = image->pixels[i];
    (void)texel;
    skinslide_image_destroy(image);
    free(file);
    return 0;
}
