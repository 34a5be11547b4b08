/* Seconds, for what a result says that each stage took. */
#define _POSIX_C_SOURCE 199309L /* clock_gettime */
#include "base.h"

#include <time.h>

double ss_now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

void ss_lap(double *since, double *sum) {
    double time = ss_now();
    *sum += time - *since;
    *since = time;
}
