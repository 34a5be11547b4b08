/* Limits how far each vertex slides: a way that is longer along the deformed surface ends where its limit is reached. */
#include "even.h"

static void limit_along_loop(const ss_evener *evener, int32_t vertex, double limit, ss_place *place) {
    double distance = ss_border_distance(&evener->pose, vertex, place);
    if (fabs(distance) <= limit)
        return;
    *place = ss_place_of_vertex(evener->sheet->patch, NULL, vertex);
    ss_walk_border(&evener->pose, place, distance < 0 ? -limit : limit);
}

static void limit_over_surface(const ss_evener *evener, int32_t vertex, double limit, ss_place *place) {
    ss_meter meter = {&evener->pose, 0, limit};
    ss_place end;
    ss_walk_turned(&evener->sheet->ground, vertex, evener->slide[vertex], &meter, &end);
    if (meter.walked >= limit)
        *place = end;
}

void ss_limit_ways(ss_evener *evener, const ss_frame *frame, ss_place *places) {
    const ss_patch *patch = evener->sheet->patch;
    ss_posed_set(&evener->pose, frame->points);
    for (int32_t i = 0; i < patch->free_count; i++) {
        int32_t v = patch->free_vertex[i];
        if (places[i].triangle == SS_STAYS || isinf(frame->limits[i]))
            continue;
        if (frame->limits[i] == 0)
            places[i].triangle = SS_STAYS;
        else
            (patch->vertex_loop[v] >= 0 ? limit_along_loop : limit_over_surface)(evener, v, frame->limits[i], &places[i]);
    }
}
