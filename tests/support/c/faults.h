/* EGL and OpenGL ES whose calls fail on demand: what a machine may do to the lookup, without such a machine. */
#ifndef SKINSLIDE_TEST_FAULTS_H
#define SKINSLIDE_TEST_FAULTS_H

#include "egl.h"
#include "support.h"

typedef struct fault {
    const char *call;   /* "eglMakeCurrent", "glMapBufferRange", ...; NULL: none */
    int32_t after;      /* calls that still succeed */
    int32_t times;      /* then so many fail; -1: all */
    uint32_t code;      /* what eglGetError, glGetError or the call itself then says */
    const char *hidden; /* an extension that EGL and the context do not have, or the beginning of some; or NULL */
    const char *shown;  /* what the only device says of itself, or NULL: what it does */
    const char *renderer;
    int32_t largest; /* texture or renderbuffer, or 0: what it is */
    int32_t devices; /* that EGL lists, or -1: what it has, which beyond that are its first again */
    int32_t robust;  /* contexts that can tell that they were lost, the first ones, or 0: all */
    bool varied;     /* EGL's errors go up from code */
} fault;

#define NO_FAULT                                                                                                               \
    { .devices = -1 }

/* From now on. For tests of one thread. */
void plan_fault(fault planned);
/* How often the planned call failed since. */
int32_t faults_struck(void);
/* A loader for ss_workspace_create and ss_device_request. */
bool load_with_faults(struct ss_egl_api *api, char *why, size_t size);
/* No library at all. */
bool load_nothing(struct ss_egl_api *api, char *why, size_t size);

#endif
