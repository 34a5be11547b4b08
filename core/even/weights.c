/* What weights below 1 come to. All of a slide is multiplied by the largest of the weights. Where a vertex has a share 0 < u < 1 of
 * that, the slide D is found twice: once as if all shares were 1, then with springs that hold each vertex at its share of that,
 *
 *     (K + A) d = u (f + A D),     A = 2 (1 / u - 1) sum of k / l^2 over its edges,     f the force
 *
 * so that d = u D where u is the same all around, on a mesh of any fineness and in a region of any size; that skin of share 1
 * evens out with what its neighbours are held to; and that a share of nearly 0 is one of 0, which stays. */
#include "even.h"

#include <string.h>

#define STIFFNESS   2
#define LEAST_SHARE 1e-6 /* by which A stays a number */

/* Returns the largest weight. */
static double spread(ss_evener *evener, const ss_frame *frame) {
    const ss_patch *patch = evener->sheet->patch;
    double most = 0;
    memset(evener->next_weight, 0, (size_t)patch->vertex_count * sizeof *evener->next_weight);
    for (int32_t i = 0; i < patch->free_count; i++)
        if (!evener->sheet->held[patch->free_vertex[i]]) {
            evener->next_weight[patch->free_vertex[i]] = frame->weights[i];
            most = fmax(most, frame->weights[i]);
        }
    return most;
}

bool ss_share_weights(ss_evener *evener, const ss_frame *frame) {
    bool shared = false;
    evener->most_weight = spread(evener, frame);
    for (int32_t v = 0; v < evener->sheet->patch->vertex_count; v++)
        if (evener->next_weight[v] > 0) {
            evener->next_weight[v] /= evener->most_weight;
            shared |= evener->next_weight[v] < 1;
        }
    return shared;
}

void ss_find_anchors(ss_evener *evener) {
    for (int32_t v = 0; v < evener->sheet->patch->vertex_count; v++) {
        double weight = evener->weight[v];
        evener->anchor[v] = weight > 0 ? STIFFNESS * (1 / fmax(weight, LEAST_SHARE) - 1) * evener->load[v] : 0;
    }
}

void ss_pull_to_shares(ss_evener *evener, const double (*whole)[2], double (*right)[2]) {
    for (int32_t v = 0; v < evener->sheet->patch->vertex_count; v++)
        for (int j = 0; j < 2 && evener->weight[v] > 0 && evener->weight[v] < 1; j++) {
            double *own = &right[ss_blocks_unknown(evener->K, v)][j];
            *own = evener->weight[v] * (*own + evener->anchor[v] * whole[v][j]);
        }
}
