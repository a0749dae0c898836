// The one owner of EGL and OpenGL: an off-screen context, and the few GL functions that the renderer calls itself.
#pragma once

#include <GL/gl.h>
#include <GL/glext.h>

#include <memory>
#include <string>

#include "rigproof/sim/render_device.h"

namespace rigproof {

/// GL entry points of a current context, loaded through eglGetProcAddress: nothing links against GL.
struct GlFunctions {
  decltype(&glGetString) GetString;
  decltype(&glGetError) GetError;
  decltype(&glGetIntegerv) GetIntegerv;
  decltype(&glFinish) Finish;
  decltype(&glReadPixels) ReadPixels;
  decltype(&glPixelStorei) PixelStorei;
  decltype(&glReadBuffer) ReadBuffer;
  decltype(&glBindTexture) BindTexture;
  decltype(&glTexParameteri) TexParameteri;
  decltype(&glTexParameterf) TexParameterf;
  decltype(&glGetFloatv) GetFloatv;
  PFNGLGENERATEMIPMAPPROC GenerateMipmap;
  PFNGLGENFRAMEBUFFERSPROC GenFramebuffers;
  PFNGLDELETEFRAMEBUFFERSPROC DeleteFramebuffers;
  PFNGLBINDFRAMEBUFFERPROC BindFramebuffer;
  PFNGLGENRENDERBUFFERSPROC GenRenderbuffers;
  PFNGLDELETERENDERBUFFERSPROC DeleteRenderbuffers;
  PFNGLBINDRENDERBUFFERPROC BindRenderbuffer;
  PFNGLRENDERBUFFERSTORAGEPROC RenderbufferStorage;
  PFNGLFRAMEBUFFERRENDERBUFFERPROC FramebufferRenderbuffer;
  PFNGLCHECKFRAMEBUFFERSTATUSPROC CheckFramebufferStatus;
};

/// A current desktop-OpenGL context without any window or surface. Bound to the thread that made it.
class EglContext {
 public:
  /// @param device -2 = first hardware device that works, else surfaceless Mesa; -1 = surfaceless Mesa; else the
  ///               index of enumerate_render_devices().
  /// Software rendering is told to use one thread (LP_NUM_THREADS=1) unless the user has set the variable.
  /// Throws Error that says what is missing and what to install.
  explicit EglContext(int device);
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  void make_current() const;
  const GlFunctions& gl() const { return gl_; }
  const std::string& renderer() const { return renderer_; }
  const std::string& version() const { return version_; }

 private:
  bool open(int device, std::string* why_not);

  struct Handles;
  static void close(Handles* handles);
  static GlFunctions load_functions(const Handles& handles);
  std::unique_ptr<Handles> handles_;
  GlFunctions gl_{};
  std::string renderer_;
  std::string version_;
};

}  // namespace rigproof
