/* Skin that a pose crushes is made to hold together more. If more than half of it should leave a crook, there are two ways out
 * that are equally good, and skin that hardly holds changes from one to the other in a frame or two: with the least hold
 * everywhere, a sleeve moved 5 times as roughly as the cache. The crush of a vertex is the mean over its edges of
 *
 *     max(0, mu - z - onset)^2
 *
 * for the cache's z and scale mu, spread twice over the neighbours; its hold is then 1 + most x / (1 + x) times as stiff, with
 * x = steepness crush.
 *
 * The constants were chosen together with the hold, for stretch taken away and for smooth motion, on half of 16 shots. With a
 * most of 4 and twice the hold, less stretch goes, and the roughest shots are no smoother. At half and at twice of each, of the
 * stretch of the example sleeve `relaxed` takes this much away, where it is 45 %, and moves the examples sleeve and face this
 * many times as roughly as their caches at quarter frames, where it is 4.6 and 1.0 times:
 *
 *     onset      44 47 %    4.8 5.3    1.7 1.6
 *     steepness  47 44 %    6.1 3.9    1.0 1.8
 *     most       51 38 %    6.0 3.6    1.3 1.8
 *     spreads    46 44 %    4.8 4.8    1.0 1.0 */
#include "even.h"

#include <string.h>

#define ONSET     0.1
#define STEEPNESS 10.0
#define MOST      7.0
#define SPREADS   2

static void measure(ss_evener *evener) {
    const ss_sheet *sheet = evener->sheet;
    memset(evener->crush, 0, (size_t)sheet->patch->vertex_count * sizeof *evener->crush);
    for (int32_t i = 0; i < sheet->spring_count; i++) {
        const ss_spring *spring = &sheet->springs[i];
        double over = evener->scale - evener->stretch[i] - ONSET;
        for (int end = 0; end < 2 && over > 0 && spring->square > 0; end++)
            evener->crush[spring->end[end]] += over * over / sheet->degree[spring->end[end]];
    }
}

/* Replaces half of each vertex's crush by half of its neighbours' mean. */
static void spread(ss_evener *evener) {
    const ss_sheet *sheet = evener->sheet;
    int32_t vertices = sheet->patch->vertex_count;
    double *crush = evener->crush, *sum = evener->part;
    memcpy(sum, crush, (size_t)vertices * sizeof *sum);
    for (int32_t i = 0; i < sheet->spring_count; i++) {
        const int32_t *v = sheet->springs[i].end;
        sum[v[0]] += crush[v[1]] / sheet->degree[v[0]];
        sum[v[1]] += crush[v[0]] / sheet->degree[v[1]];
    }
    for (int32_t v = 0; v < vertices; v++)
        crush[v] = 0.5 * sum[v];
}

void ss_stiffen_holds(ss_evener *evener, const double *holds) {
    measure(evener);
    for (int i = 0; i < SPREADS; i++)
        spread(evener);
    for (int32_t v = 0; v < evener->sheet->patch->vertex_count; v++) {
        double x = STEEPNESS * evener->crush[v];
        evener->next_hold[v] = holds[v] * (1 + MOST * x / (1 + x));
    }
}
