/* Hosts: programs that call us while an EGL context of their own is current. */
#ifndef SKINSLIDE_TEST_HOSTS_H
#define SKINSLIDE_TEST_HOSTS_H

#include "egl.h"

typedef struct host {
    ss_egl_api egl;
    EGLDisplay display;
    EGLContext context;
    EGLSurface draw, read;
} host;

/* Makes a host whose context, of an API on a platform, is current from now on. */
host host_with(EGLenum api, EGLenum platform);
/* Asserts that its context and surfaces are still current, and that the API bound is still bound. */
void assert_current(const host *h, EGLenum api, EGLenum bound);
/* Paints both surfaces; then asserts that they are as painted, and that no call of the host's has failed. */
void paint_host(const host *h, EGLenum api);
void assert_painted(const host *h, EGLenum api);
void end_host(host *h);

#endif
