/* How the transforms above a mesh scale it: the lengths that its points, as rows, have in the world by the matrix A that takes
 * them there.
 *
 *     |p A|^2 = p G p^T,   G = A A^T = L L^T,   so p L has the lengths that p has in the world
 *
 * L is lower triangular, and does not depend on how the mesh is rotated or where it is, which may change from frame to
 * frame. */
#include "stage.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A scale counts as even if it is at most this many times as much one way as another. */
static const double even = 1.01;
/* How much G may change over time, relative to it: the rounding that rotating transforms of a rig leave. */
static const double still = 1e-4;

typedef struct gram {
    double of[3][3];
} gram;

static bool take_gram(const double to_world[16], gram *out) {
    bool finite = true;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            out->of[i][j] = ss_dot(to_world + 4 * i, to_world + 4 * j);
            finite = finite && isfinite(out->of[i][j]);
        }
    return finite;
}

static double trace(const gram *g) {
    return g->of[0][0] + g->of[1][1] + g->of[2][2];
}

/* One rotation of Jacobi's method: makes the entry between two axes 0. */
static void turn(gram *g, int p, int q) {
    double between = g->of[p][q];
    if (between == 0)
        return;
    double theta = (g->of[q][q] - g->of[p][p]) / (2 * between);
    double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1)), c = 1 / sqrt(t * t + 1), s = t * c;
    for (int k = 0; k < 3; k++) {
        double a = g->of[k][p], b = g->of[k][q];
        g->of[k][p] = c * a - s * b, g->of[k][q] = s * a + c * b;
    }
    for (int k = 0; k < 3; k++) {
        double a = g->of[p][k], b = g->of[q][k];
        g->of[p][k] = c * a - s * b, g->of[q][k] = s * a + c * b;
    }
}

/* The largest scale over the smallest: the square root of the ratio of eigenvalues. 1 where all is in one point; at most
 * 1e6. */
static double unevenness(gram g) {
    enum { SWEEPS = 12 }; /* more than enough: a few converge */
    for (int sweep = 0; sweep < SWEEPS; sweep++)
        for (int p = 0; p < 2; p++)
            for (int q = p + 1; q < 3; q++)
                turn(&g, p, q);
    double least = fmin(g.of[0][0], fmin(g.of[1][1], g.of[2][2])), most = fmax(g.of[0][0], fmax(g.of[1][1], g.of[2][2]));
    return most > 0 ? sqrt(most / fmax(least, 1e-12 * most)) : 1;
}

/* Finds Cholesky's factor, rounded to floats, so that rotations of the mesh leave no noise in it. False if G is not positive
 * definite. */
static bool factor(const gram *g, double out[9]) {
    memset(out, 0, 9 * sizeof *out);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j <= i; j++) {
            double left = g->of[i][j];
            for (int k = 0; k < j; k++)
                left -= out[3 * i + k] * out[3 * j + k];
            if (i == j && !(left > 1e-12 * g->of[i][i]))
                return false;
            out[3 * i + j] = i == j ? sqrt(left) : left / out[3 * j + j];
        }
    for (int k = 0; k < 9; k++)
        out[k] = (float)out[k];
    return true;
}

static const char *option_name(char text[64]) {
    int32_t count;
    const skinslide_stage_input *input = &ss_inputs(SKINSLIDE_STAGE_MESH, &count)[SS_ROW_WORLD_SPACE].shown;
    snprintf(text, 64, "%s%s", input->prefix, input->name);
    return text;
}

static skinslide_status warn(skinslide_stage_mesh *mesh, double ratio, double frame, bool is_first, skinslide_error *error) {
    char at[48] = "", name[64], number[32];
    char *warning = SS_NEW(&mesh->memory, char, 224);
    if (!warning)
        return ss_out_of_memory(error);
    skinslide_stage_frame_text(frame, number);
    if (!is_first)
        snprintf(at, sizeof at, ", most at frame %s", number);
    snprintf(warning, 224,
             "the transforms above scale it %.3g times as much one way as another%s: lengths are taken in its own space, and "
             "in the world's with %s = true",
             ratio, at, option_name(name));
    mesh->space_warning = warning, mesh->unevenness = ratio;
    return SKINSLIDE_OK;
}

/* Warns of a scale that is not even, for the frame at which it is least so. */
static skinslide_status look(skinslide_stage_mesh *mesh, const gram *g, double frame, bool is_first, skinslide_error *error) {
    double ratio = unevenness(*g);
    return ratio > even * fmax(1, mesh->unevenness) ? warn(mesh, ratio, frame, is_first, error) : SKINSLIDE_OK;
}

/* Takes the space in which lengths are measured, which may change over time in size only. */
static skinslide_status take(skinslide_stage_mesh *mesh, const gram *g, double frame, bool is_first, skinslide_error *error) {
    char name[64], number[32];
    double size = trace(g), before = 0;
    skinslide_stage_frame_text(frame, number);
    if (is_first && !factor(g, mesh->space))
        return ss_fail(error, SKINSLIDE_BAD_CONTROL,
                       "%s: the transforms above flatten it, so that it has no lengths in the world", option_name(name));
    if (is_first)
        memcpy(mesh->gram, g->of, sizeof g->of);
    before = mesh->gram[0] + mesh->gram[4] + mesh->gram[8];
    for (int k = 0; k < 9; k++)
        if (!(fabs(g->of[k / 3][k % 3] / size - mesh->gram[k] / before) <= still))
            return ss_fail(error, SKINSLIDE_BAD_CONTROL,
                           "%s: the transforms above scale it otherwise at frame %s than at first; only their size may change",
                           option_name(name), number);
    return SKINSLIDE_OK;
}

skinslide_status skinslide_stage_mesh_space(skinslide_stage_mesh *mesh, const double to_world[16], double frame,
                                            skinslide_error *error) {
    if (!mesh || !to_world)
        return ss_fail(error, SKINSLIDE_BAD_ARGUMENT, "no mesh, or no way to the world");
    gram g;
    bool is_first = !mesh->has_space, finite = take_gram(to_world, &g);
    mesh->has_space = true;
    if (mesh->world_space == 0)
        return finite ? look(mesh, &g, frame, is_first, error) : SKINSLIDE_OK;
    skinslide_status status = finite ? take(mesh, &g, frame, is_first, error)
                                     : ss_fail(error, SKINSLIDE_BAD_CONTROL, "the way to the world is not finite");
    mesh->taken[SS_ROW_WORLD_SPACE].refused = mesh->taken[SS_ROW_WORLD_SPACE].refused || status;
    return status;
}

const char *skinslide_stage_mesh_space_warning(const skinslide_stage_mesh *mesh) {
    return mesh ? mesh->space_warning : NULL;
}
