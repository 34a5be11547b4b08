/* Weights below 1. The whole slide is multiplied by the largest weight. If a vertex has a share 0 < u < 1 of that, the slide is
 * found twice: D as if all shares were 1, then d with springs that hold each vertex at its share of D,
 *
 *     (K + A) d = u (f + A D),     A = 2 (1 / u - 1) sum of k / l^2 over its edges,     f the force
 *
 * so that d = u D where u is the same all around, however fine the mesh and large the region; skin of share 1 evens out with
 * neighbours that are held back; and a share of nearly 0 acts as 0, which stays. */
#include "even.h"

#include <string.h>

#define STIFFNESS   2    /* spots of share 0.5, of any size, then slide by 0.48 to 0.53 of D on a face */
#define LEAST_SHARE 1e-6 /* keeps A finite */

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
