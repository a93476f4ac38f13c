// The functions of OSMesa and OpenGL that the renderer calls, as pointers with the names of the functions.
//
// libOSMesa is loaded with the first context. With the compiler that it needs, loading takes 70 ms of processor time
// and 50 MB of memory: more than the whole proof of a short check, which draws nothing.
#pragma once

#include <rehearse/diagnostic.h>

#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>

#define REHEARSE_OSMESA_FUNCTIONS(X) \
  X(OSMesaCreateContextAttribs)      \
  X(OSMesaDestroyContext) X(OSMesaGetCurrentContext) X(OSMesaGetProcAddress) X(OSMesaMakeCurrent)

#define REHEARSE_GL_FUNCTIONS(X)                                                                                     \
  X(glActiveTexture)                                                                                                 \
  X(glAttachShader) X(glBindBuffer) X(glBindFramebuffer) X(glBindRenderbuffer) X(glBindTexture) X(glBindVertexArray) \
      X(glBlendFunc) X(glBufferData) X(glCheckFramebufferStatus) X(glClear) X(glClearBufferfv) X(glClearDepth)       \
          X(glClipControl) X(glCompileShader) X(glCreateProgram) X(glCreateShader) X(glCullFace)                     \
              X(glDeleteFramebuffers) X(glDeleteRenderbuffers) X(glDeleteShader) X(glDepthFunc) X(glDisable)         \
                  X(glDisablei) X(glDrawBuffer) X(glDrawBuffers) X(glDrawElementsInstanced) X(glEnable)              \
                      X(glEnableVertexAttribArray) X(glEnablei) X(glFinish) X(glFramebufferRenderbuffer)             \
                          X(glFramebufferTexture2D) X(glFrontFace) X(glGenBuffers) X(glGenFramebuffers)              \
                              X(glGenRenderbuffers) X(glGenTextures) X(glGenVertexArrays) X(glGenerateMipmap)        \
                                  X(glGetError) X(glGetIntegerv) X(glGetProgramiv) X(glGetShaderiv) X(glGetString)   \
                                      X(glGetUniformLocation) X(glLinkProgram) X(glPixelStorei) X(glReadBuffer)      \
                                          X(glReadPixels) X(glRenderbufferStorage) X(glShaderSource) X(glTexImage2D) \
                                              X(glTexParameteri) X(glUniform1f) X(glUniform1i) X(glUniform3fv)       \
                                                  X(glUniform4fv) X(glUniformMatrix4fv) X(glUseProgram)              \
                                                      X(glVertexAttribDivisor) X(glVertexAttribPointer) X(glViewport)

namespace rehearse::gl {

// Inside of this namespace they hide the functions that the headers of OpenGL declare.
#define REHEARSE_DECLARE(name) extern decltype(&::name) name;
REHEARSE_OSMESA_FUNCTIONS(REHEARSE_DECLARE)
REHEARSE_GL_FUNCTIONS(REHEARSE_DECLARE)
#undef REHEARSE_DECLARE

/// Loads libOSMesa, unless it is loaded, and sets the pointers. Fails without the library, or if it is too old to have
/// all functions. A function of OpenGL needs a current context.
Result<void> load_functions();

}  // namespace rehearse::gl
