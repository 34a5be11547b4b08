/* EGL and OpenGL ES 3.0 as tables of functions, and a context of our own on them. */
#ifndef SKINSLIDE_EGL_H
#define SKINSLIDE_EGL_H

#define EGL_NO_X11 1
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES3/gl3.h>

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What every EGL since 1.4 exports. */
#define SS_EGL_FUNCTIONS(X)                                                                                                    \
    X(PFNEGLBINDAPIPROC, eglBindAPI)                                                                                           \
    X(PFNEGLCHOOSECONFIGPROC, eglChooseConfig)                                                                                 \
    X(PFNEGLCREATECONTEXTPROC, eglCreateContext)                                                                               \
    X(PFNEGLCREATEPBUFFERSURFACEPROC, eglCreatePbufferSurface)                                                                 \
    X(PFNEGLDESTROYCONTEXTPROC, eglDestroyContext)                                                                             \
    X(PFNEGLDESTROYSURFACEPROC, eglDestroySurface)                                                                             \
    X(PFNEGLGETCURRENTCONTEXTPROC, eglGetCurrentContext)                                                                       \
    X(PFNEGLGETCURRENTDISPLAYPROC, eglGetCurrentDisplay)                                                                       \
    X(PFNEGLGETCURRENTSURFACEPROC, eglGetCurrentSurface)                                                                       \
    X(PFNEGLGETDISPLAYPROC, eglGetDisplay)                                                                                     \
    X(PFNEGLGETERRORPROC, eglGetError)                                                                                         \
    X(PFNEGLGETPROCADDRESSPROC, eglGetProcAddress)                                                                             \
    X(PFNEGLINITIALIZEPROC, eglInitialize)                                                                                     \
    X(PFNEGLMAKECURRENTPROC, eglMakeCurrent)                                                                                   \
    X(PFNEGLQUERYAPIPROC, eglQueryAPI)                                                                                         \
    X(PFNEGLQUERYSTRINGPROC, eglQueryString)

/* NULL if the client extensions do not include them. */
#define SS_EGL_EXTENSIONS(X)                                                                                                   \
    X(PFNEGLGETPLATFORMDISPLAYEXTPROC, eglGetPlatformDisplayEXT)                                                               \
    X(PFNEGLQUERYDEVICESEXTPROC, eglQueryDevicesEXT)                                                                           \
    X(PFNEGLQUERYDEVICESTRINGEXTPROC, eglQueryDeviceStringEXT)

#define SS_GL_FUNCTIONS(X)                                                                                                     \
    X(PFNGLATTACHSHADERPROC, glAttachShader)                                                                                   \
    X(PFNGLBEGINTRANSFORMFEEDBACKPROC, glBeginTransformFeedback)                                                               \
    X(PFNGLBINDBUFFERPROC, glBindBuffer)                                                                                       \
    X(PFNGLBINDBUFFERBASEPROC, glBindBufferBase)                                                                               \
    X(PFNGLBINDFRAMEBUFFERPROC, glBindFramebuffer)                                                                             \
    X(PFNGLBINDRENDERBUFFERPROC, glBindRenderbuffer)                                                                           \
    X(PFNGLBINDTEXTUREPROC, glBindTexture)                                                                                     \
    X(PFNGLBINDVERTEXARRAYPROC, glBindVertexArray)                                                                             \
    X(PFNGLBLENDCOLORPROC, glBlendColor)                                                                                       \
    X(PFNGLBLENDFUNCPROC, glBlendFunc)                                                                                         \
    X(PFNGLBLITFRAMEBUFFERPROC, glBlitFramebuffer)                                                                             \
    X(PFNGLBUFFERDATAPROC, glBufferData)                                                                                       \
    X(PFNGLCHECKFRAMEBUFFERSTATUSPROC, glCheckFramebufferStatus)                                                               \
    X(PFNGLCLEARBUFFERFIPROC, glClearBufferfi)                                                                                 \
    X(PFNGLCLEARBUFFERFVPROC, glClearBufferfv)                                                                                 \
    X(PFNGLCLEARBUFFERIVPROC, glClearBufferiv)                                                                                 \
    X(PFNGLCLEARBUFFERUIVPROC, glClearBufferuiv)                                                                               \
    X(PFNGLCOLORMASKPROC, glColorMask)                                                                                         \
    X(PFNGLCOMPILESHADERPROC, glCompileShader)                                                                                 \
    X(PFNGLCREATEPROGRAMPROC, glCreateProgram)                                                                                 \
    X(PFNGLCREATESHADERPROC, glCreateShader)                                                                                   \
    X(PFNGLDELETESHADERPROC, glDeleteShader)                                                                                   \
    X(PFNGLDELETETEXTURESPROC, glDeleteTextures)                                                                               \
    X(PFNGLDEPTHFUNCPROC, glDepthFunc)                                                                                         \
    X(PFNGLDISABLEPROC, glDisable)                                                                                             \
    X(PFNGLDRAWARRAYSPROC, glDrawArrays)                                                                                       \
    X(PFNGLDRAWARRAYSINSTANCEDPROC, glDrawArraysInstanced)                                                                     \
    X(PFNGLDRAWBUFFERSPROC, glDrawBuffers)                                                                                     \
    X(PFNGLDRAWELEMENTSPROC, glDrawElements)                                                                                   \
    X(PFNGLENABLEPROC, glEnable)                                                                                               \
    X(PFNGLENABLEVERTEXATTRIBARRAYPROC, glEnableVertexAttribArray)                                                             \
    X(PFNGLENDTRANSFORMFEEDBACKPROC, glEndTransformFeedback)                                                                   \
    X(PFNGLFRAMEBUFFERRENDERBUFFERPROC, glFramebufferRenderbuffer)                                                             \
    X(PFNGLFRAMEBUFFERTEXTURE2DPROC, glFramebufferTexture2D)                                                                   \
    X(PFNGLFRONTFACEPROC, glFrontFace)                                                                                         \
    X(PFNGLGENBUFFERSPROC, glGenBuffers)                                                                                       \
    X(PFNGLGENFRAMEBUFFERSPROC, glGenFramebuffers)                                                                             \
    X(PFNGLGENRENDERBUFFERSPROC, glGenRenderbuffers)                                                                           \
    X(PFNGLGENTEXTURESPROC, glGenTextures)                                                                                     \
    X(PFNGLGENVERTEXARRAYSPROC, glGenVertexArrays)                                                                             \
    X(PFNGLGENERATEMIPMAPPROC, glGenerateMipmap)                                                                               \
    X(PFNGLGETERRORPROC, glGetError)                                                                                           \
    X(PFNGLGETINTEGERVPROC, glGetIntegerv)                                                                                     \
    X(PFNGLGETPROGRAMINFOLOGPROC, glGetProgramInfoLog)                                                                         \
    X(PFNGLGETPROGRAMIVPROC, glGetProgramiv)                                                                                   \
    X(PFNGLGETSTRINGPROC, glGetString)                                                                                         \
    X(PFNGLGETUNIFORMLOCATIONPROC, glGetUniformLocation)                                                                       \
    X(PFNGLLINKPROGRAMPROC, glLinkProgram)                                                                                     \
    X(PFNGLMAPBUFFERRANGEPROC, glMapBufferRange)                                                                               \
    X(PFNGLPOLYGONOFFSETPROC, glPolygonOffset)                                                                                 \
    X(PFNGLREADBUFFERPROC, glReadBuffer)                                                                                       \
    X(PFNGLREADPIXELSPROC, glReadPixels)                                                                                       \
    X(PFNGLRENDERBUFFERSTORAGEPROC, glRenderbufferStorage)                                                                     \
    X(PFNGLRENDERBUFFERSTORAGEMULTISAMPLEPROC, glRenderbufferStorageMultisample)                                               \
    X(PFNGLSCISSORPROC, glScissor)                                                                                             \
    X(PFNGLSHADERSOURCEPROC, glShaderSource)                                                                                   \
    X(PFNGLSTENCILFUNCPROC, glStencilFunc)                                                                                     \
    X(PFNGLSTENCILOPPROC, glStencilOp)                                                                                         \
    X(PFNGLTEXPARAMETERIPROC, glTexParameteri)                                                                                 \
    X(PFNGLTEXSTORAGE2DPROC, glTexStorage2D)                                                                                   \
    X(PFNGLTEXSUBIMAGE2DPROC, glTexSubImage2D)                                                                                 \
    X(PFNGLTRANSFORMFEEDBACKVARYINGSPROC, glTransformFeedbackVaryings)                                                         \
    X(PFNGLUNIFORM1IPROC, glUniform1i)                                                                                         \
    X(PFNGLUNIFORM3FVPROC, glUniform3fv)                                                                                       \
    X(PFNGLUNIFORMMATRIX3FVPROC, glUniformMatrix3fv)                                                                           \
    X(PFNGLUNIFORMMATRIX4FVPROC, glUniformMatrix4fv)                                                                           \
    X(PFNGLUNMAPBUFFERPROC, glUnmapBuffer)                                                                                     \
    X(PFNGLUSEPROGRAMPROC, glUseProgram)                                                                                       \
    X(PFNGLVERTEXATTRIBDIVISORPROC, glVertexAttribDivisor)                                                                     \
    X(PFNGLVERTEXATTRIBIPOINTERPROC, glVertexAttribIPointer)                                                                   \
    X(PFNGLVERTEXATTRIBPOINTERPROC, glVertexAttribPointer)                                                                     \
    X(PFNGLVIEWPORTPROC, glViewport)

typedef struct ss_egl_api {
#define SS_MEMBER(type, name) type name;
    SS_EGL_FUNCTIONS(SS_MEMBER)
    SS_EGL_EXTENSIONS(SS_MEMBER)
    SS_GL_FUNCTIONS(SS_MEMBER)
#undef SS_MEMBER
    GLenum (*glGetGraphicsResetStatus)(void); /* NULL where contexts cannot tell that they were lost */
} ss_egl_api;

/* Fills the table; where it cannot, says why. Tests give tables that fail. */
typedef bool (*ss_egl_loader)(ss_egl_api *api, char *why, size_t size);
bool ss_egl_load(ss_egl_api *api, char *why, size_t size);

typedef struct ss_device_request {
    ss_egl_loader load;
    int32_t device;     /* of EGL's devices, or SKINSLIDE_ANY_DEVICE */
    bool hardware_only; /* a software rasteriser will not do */
} ss_device_request;

/* A context on a display, made current only between enter and leave. */
typedef struct ss_egl {
    ss_egl_api api;
    EGLDisplay display;
    EGLContext context;
    EGLSurface surface; /* EGL_NO_SURFACE, or a pixel where contexts need a surface */
    skinslide_device_info info;
} ss_egl;

/* What was current on the thread before. */
typedef struct ss_egl_before {
    EGLenum api;
    EGLDisplay display;
    EGLContext context;
    EGLSurface draw, read;
    EGLint failure; /* of an enter that failed */
} ss_egl_before;

/* A number that one of EGL's devices can have, or SKINSLIDE_ANY_DEVICE. */
skinslide_status ss_egl_check_device(int32_t device, skinslide_error *error);
/* Makes a context, which is not current yet. Fails with NO_DEVICE, naming all that was tried and EGL's error for each. */
skinslide_status ss_egl_open(const ss_device_request *request, ss_egl **out, skinslide_error *error);
/* NULL does nothing. Never ends the display, which the process shares. */
void ss_egl_close(ss_egl *egl);
/* Makes the context current and remembers what was; where it fails, what was current still is. */
bool ss_egl_enter(const ss_egl *egl, ss_egl_before *before);
void ss_egl_leave(const ss_egl *egl, const ss_egl_before *before);
/* "EGL_BAD_ALLOC"; "an unknown error" for a number that EGL does not have. */
const char *ss_egl_error_name(EGLint code);
/* Whether no OpenGL call has failed since the context was entered; else says what failed. */
bool ss_gl_did(const ss_egl_api *gl, char *failure, size_t size);
/* ss_egl_enter; DEVICE_FAILED where it fails. */
skinslide_status ss_gl_enter(const ss_egl *egl, ss_egl_before *before, skinslide_error *error);
/* Makes current again what was current before. DEVICE_FAILED if a call failed since the enter; `what` begins the message. */
skinslide_status ss_gl_leave(const ss_egl *egl, const ss_egl_before *before, const char *what, skinslide_error *error);
/* Whether the context, which is current, has an extension. */
bool ss_gl_has(const ss_egl_api *gl, const char *extension);
enum { SS_BAND_ROWS = 16 };
/* Reads texels [low, high) of integers, the lowest row first, in bands of rows, in the only format that every device must
 * support: four numbers for each texel. band is scratch [SS_BAND_ROWS * width]. */
void ss_gl_read_numbers(const ss_egl_api *gl, const int32_t low[2], const int32_t high[2], uint32_t (*band)[4],
                        uint32_t *texels);
/* Links a program, capturing the outputs [captured_count] of its vertex shader where there are any. */
skinslide_status ss_gl_program(const ss_egl_api *gl, const char *vertex, const char *fragment, const char *const *captured,
                               int32_t captured_count, GLuint *program, skinslide_error *error);

#ifdef __cplusplus
}
#endif

#endif
