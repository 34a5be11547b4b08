/* EGL and OpenGL ES whose calls fail on demand, to test what bad machines may do to the lookup. */
#ifndef SKINSLIDE_TEST_FAULTS_H
#define SKINSLIDE_TEST_FAULTS_H

#include "egl.h"
#include "support.h"

typedef struct fault {
    const char *call;   /* "eglMakeCurrent", "glMapBufferRange", ...; NULL: none */
    int32_t after;      /* calls that still succeed */
    int32_t times;      /* how many fail after that; -1: all */
    uint32_t code;      /* what eglGetError, glGetError or the call itself then returns */
    const char *hidden; /* an extension, or the beginning of several, that EGL and the context lack; or NULL */
    const char *shown;  /* what the only device says of itself, or NULL: what it does */
    const char *renderer;
    int32_t largest; /* largest texture or renderbuffer; 0: as it is */
    int32_t devices; /* how many EGL lists, the first repeated if it has fewer; -1: as it is */
    int32_t robust;  /* how many contexts, the first ones, can tell that they were lost; 0: all */
    bool varied;     /* EGL's errors go up from code */
} fault;

#define NO_FAULT                                                                                                               \
    { .devices = -1 }

/* Plans a fault from now on. For tests with one thread. */
void plan_fault(fault planned);
/* How often the planned call has failed since. */
int32_t faults_struck(void);
/* A loader for ss_workspace_create and ss_device_request. */
bool load_with_faults(struct ss_egl_api *api, char *why, size_t size);
/* A loader that finds no library at all. */
bool load_nothing(struct ss_egl_api *api, char *why, size_t size);

#endif
