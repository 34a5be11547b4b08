/* Programs that have an EGL context of their own current while they call us. */
#ifndef SKINSLIDE_TEST_HOSTS_H
#define SKINSLIDE_TEST_HOSTS_H

#include "egl.h"

typedef struct host {
    ss_egl_api egl;
    EGLDisplay display;
    EGLContext context;
    EGLSurface draw, read;
} host;

/* Whose context, of an API on a platform, is current from now on. */
host host_with(EGLenum api, EGLenum platform);
/* It still is, with its surfaces, and the API bound that was. */
void assert_current(const host *h, EGLenum api, EGLenum bound);
/* Paints both of its surfaces; asserts that they are as painted, and that no call of the host's has failed. */
void paint_host(const host *h, EGLenum api);
void assert_painted(const host *h, EGLenum api);
void end_host(host *h);

#endif
