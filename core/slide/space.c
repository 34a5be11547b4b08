/* Where lengths are taken: in the mesh's own space or, by a linear map, in another, such as the world's, in which the skin of a
 * mesh that is scaled more one way than another is seen. A slide is all in that space, and what comes of it goes back:
 *
 *     p' = p M,   d = d' M^-1      rows; d the displacement of a vertex */
#include "slide.h"

#include <string.h>

/* The inverse, by cofactors. False if there is none, or it is not finite. */
static bool invert(const double m[9], double out[9]) {
    double determinant = 0;
    bool finite = true;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const double *a = m + 3 * ((j + 1) % 3), *b = m + 3 * ((j + 2) % 3);
            out[3 * i + j] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
        }
    for (int k = 0; k < 3; k++)
        determinant += m[k] * out[3 * k];
    for (int k = 0; k < 9; k++) {
        out[k] /= determinant;
        finite = finite && isfinite(out[k]) && isfinite(m[k]);
    }
    return finite;
}

skinslide_status ss_take_space(skinslide_slider *slider, const skinslide_mesh *mesh, skinslide_error *error) {
    if (!mesh->space)
        return SKINSLIDE_OK;
    slider->space = SS_NEW(&slider->memory, ss_space, 1);
    if (!slider->space)
        return ss_out_of_memory(error);
    for (int k = 0; k < 9; k++)
        slider->space->to[k] = mesh->space[k];
    if (!invert(slider->space->to, slider->space->back))
        return ss_fail(error, SKINSLIDE_BAD_MESH, "space: the matrix is not finite, or has no inverse");
    return SKINSLIDE_OK;
}

static void map(const double m[9], const double in[3], double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = in[0] * m[k] + in[1] * m[3 + k] + in[2] * m[6 + k];
}

void ss_bring(const skinslide_slider *slider, const float **points, float *room) {
    const float *from = *points;
    if (!slider->space)
        return;
    for (int64_t v = 0; v < slider->vertex_count; v++) {
        double here[3] = {from[3 * v], from[3 * v + 1], from[3 * v + 2]}, there[3];
        map(slider->space->to, here, there);
        for (int k = 0; k < 3; k++)
            room[3 * v + k] = (float)there[k];
    }
    *points = room;
}

void ss_take_back(const skinslide_slider *slider, const double displacement[3], double out[3]) {
    if (slider->space)
        map(slider->space->back, displacement, out);
    else
        memcpy(out, displacement, 3 * sizeof *out);
}
