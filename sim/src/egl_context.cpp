#include "egl_context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

#include <array>
#include <cstdlib>
#include <cstring>

#include "rigproof/core/error.h"

namespace rigproof {
namespace {

constexpr const char* kInstallEgl = "install it with: apt-get install libegl1 libgl1-mesa-dri";
constexpr int kSurfaceless = -1;
constexpr int kAnyDevice = -2;

// libEGL, opened at run time so that a program without it starts, and can say what to install.
struct EglLibrary {
  void* handle = nullptr;
  decltype(&eglGetProcAddress) GetProcAddress = nullptr;
  decltype(&eglQueryString) QueryString = nullptr;
  decltype(&eglInitialize) Initialize = nullptr;
  decltype(&eglTerminate) Terminate = nullptr;
  decltype(&eglBindAPI) BindAPI = nullptr;
  decltype(&eglChooseConfig) ChooseConfig = nullptr;
  decltype(&eglCreateContext) CreateContext = nullptr;
  decltype(&eglDestroyContext) DestroyContext = nullptr;
  decltype(&eglMakeCurrent) MakeCurrent = nullptr;
  decltype(&eglGetCurrentContext) GetCurrentContext = nullptr;
  decltype(&eglGetError) GetError = nullptr;
  PFNEGLGETPLATFORMDISPLAYEXTPROC GetPlatformDisplay = nullptr;
  PFNEGLQUERYDEVICESEXTPROC QueryDevices = nullptr;
  PFNEGLQUERYDEVICESTRINGEXTPROC QueryDeviceString = nullptr;
  std::string client_extensions;
};

template <typename Function>
bool load_symbol(void* handle, const char* name, Function* function) {
  *function = reinterpret_cast<Function>(dlsym(handle, name));
  return *function != nullptr;
}

template <typename Function>
void load_extension(const EglLibrary& egl, const char* name, Function* function) {
  *function = reinterpret_cast<Function>(egl.GetProcAddress(name));
}

std::string load_library(EglLibrary* egl) {
  // For tests, and for people whose libEGL lies elsewhere.
  const char* override_name = std::getenv("RIGPROOF_LIBEGL");
  const std::string name = override_name != nullptr ? override_name : "libEGL.so.1";
  egl->handle = dlopen(name.c_str(), RTLD_NOW | RTLD_GLOBAL);
  if (egl->handle == nullptr) return "there is no " + name + " on this machine; " + kInstallEgl;
  const bool complete = load_symbol(egl->handle, "eglGetProcAddress", &egl->GetProcAddress) &&
                        load_symbol(egl->handle, "eglQueryString", &egl->QueryString) &&
                        load_symbol(egl->handle, "eglInitialize", &egl->Initialize) &&
                        load_symbol(egl->handle, "eglTerminate", &egl->Terminate) &&
                        load_symbol(egl->handle, "eglBindAPI", &egl->BindAPI) &&
                        load_symbol(egl->handle, "eglChooseConfig", &egl->ChooseConfig) &&
                        load_symbol(egl->handle, "eglCreateContext", &egl->CreateContext) &&
                        load_symbol(egl->handle, "eglDestroyContext", &egl->DestroyContext) &&
                        load_symbol(egl->handle, "eglMakeCurrent", &egl->MakeCurrent) &&
                        load_symbol(egl->handle, "eglGetCurrentContext", &egl->GetCurrentContext) &&
                        load_symbol(egl->handle, "eglGetError", &egl->GetError);
  if (!complete) return name + " is not a usable EGL library; " + kInstallEgl;
  load_extension(*egl, "eglGetPlatformDisplayEXT", &egl->GetPlatformDisplay);
  load_extension(*egl, "eglQueryDevicesEXT", &egl->QueryDevices);
  load_extension(*egl, "eglQueryDeviceStringEXT", &egl->QueryDeviceString);
  const char* extensions = egl->QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  egl->client_extensions = extensions != nullptr ? extensions : "";
  if (egl->GetPlatformDisplay == nullptr)
    return "the EGL library cannot render without a display (no EGL_EXT_platform_base); " + std::string(kInstallEgl);
  return {};
}

// The library or, second, why it cannot be had. Not cached when it fails: a test may change the environment.
const EglLibrary* egl_library(std::string* problem) {
  static EglLibrary library;
  static bool loaded = false;
  if (loaded && std::getenv("RIGPROOF_LIBEGL") == nullptr) return &library;
  EglLibrary candidate;
  *problem = load_library(&candidate);
  if (!problem->empty()) return nullptr;
  library = candidate;
  loaded = true;
  return &library;
}

std::vector<EGLDeviceEXT> query_devices(const EglLibrary& egl) {
  std::array<EGLDeviceEXT, 32> devices{};
  EGLint count = 0;
  if (egl.QueryDevices == nullptr || egl.QueryDeviceString == nullptr) return {};
  if (egl.QueryDevices(static_cast<EGLint>(devices.size()), devices.data(), &count) != EGL_TRUE) return {};
  return {devices.begin(), devices.begin() + count};
}

RenderDevice describe_device(const EglLibrary& egl, EGLDeviceEXT handle, int index) {
  RenderDevice device;
  device.index = index;
  const char* extensions = egl.QueryDeviceString(handle, EGL_EXTENSIONS);
  if (extensions != nullptr) {
    device.is_software = std::strstr(extensions, "EGL_MESA_device_software") != nullptr;
    if (std::strstr(extensions, "EGL_EXT_device_drm") != nullptr) {
      const char* drm_file = egl.QueryDeviceString(handle, EGL_DRM_DEVICE_FILE_EXT);
      if (drm_file != nullptr) device.drm_file = drm_file;
    }
  }
  return device;
}

bool has_surfaceless(const EglLibrary& egl) {
  return egl.client_extensions.find("EGL_MESA_platform_surfaceless") != std::string::npos;
}

std::string device_label(int device) {
  return device == kSurfaceless ? "surfaceless Mesa" : "EGL device " + std::to_string(device);
}

}  // namespace

std::vector<RenderDevice> enumerate_render_devices(std::string* problem) {
  std::string why_not;
  const EglLibrary* egl = egl_library(&why_not);
  std::vector<RenderDevice> hardware, software;
  if (egl != nullptr) {
    const std::vector<EGLDeviceEXT> handles = query_devices(*egl);
    for (std::size_t i = 0; i < handles.size(); ++i) {
      const RenderDevice device = describe_device(*egl, handles[i], static_cast<int>(i));
      (device.is_software ? software : hardware).push_back(device);
    }
    if (has_surfaceless(*egl)) {
      RenderDevice surfaceless;
      surfaceless.is_software = true;
      software.push_back(surfaceless);
    }
    if (hardware.empty() && software.empty())
      why_not =
          "EGL is installed but offers no device to render on; the driver is missing, " + std::string(kInstallEgl);
  }
  if (problem != nullptr) *problem = why_not;
  hardware.insert(hardware.end(), software.begin(), software.end());
  return hardware;
}

struct EglContext::Handles {
  const EglLibrary* egl = nullptr;
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
};

namespace {

std::string driver_text(const GlFunctions& gl, GLenum name) {
  const GLubyte* value = gl.GetString(name);
  return value != nullptr ? std::string(reinterpret_cast<const char*>(value)) : std::string();
}

}  // namespace

EglContext::EglContext(int device) : handles_(std::make_unique<Handles>()) {
  // Many processes with one thread each beat one process with many threads.
  setenv("LP_NUM_THREADS", "1", 0);
  std::string problem;
  const std::vector<RenderDevice> devices = enumerate_render_devices(&problem);
  if (devices.empty()) throw Error("cannot render: " + problem);
  handles_->egl = egl_library(&problem);
  std::string failures;
  bool known = false;
  for (const RenderDevice& candidate : devices) {
    if (device != kAnyDevice && device != candidate.index) continue;
    // A software device among the enumerated ones is what surfaceless Mesa is, with more to go wrong.
    if (device == kAnyDevice && candidate.is_software && candidate.index != kSurfaceless && devices.size() > 1)
      continue;
    known = true;
    std::string why_not;
    if (open(candidate.index, &why_not)) {
      gl_ = load_functions(*handles_);
      renderer_ = driver_text(gl_, GL_RENDERER);
      version_ = driver_text(gl_, GL_VERSION);
      return;
    }
    close(handles_.get());
    failures += (failures.empty() ? "" : "; ") + device_label(candidate.index) + ": " + why_not;
  }
  if (!known) {
    std::string choices;
    for (const RenderDevice& candidate : devices) choices += " " + std::to_string(candidate.index);
    throw Error("render device " + std::to_string(device) + " does not exist; there are:" + choices +
                " (-1 = software, -2 = the first that works)");
  }
  throw Error("cannot make an OpenGL context (" + failures + "); the driver is missing or too old, " + kInstallEgl);
}

EglContext::~EglContext() { close(handles_.get()); }

void require_render_device(int device) { const EglContext context(device); }

bool EglContext::open(int device, std::string* why_not) {
  const EglLibrary& egl = *handles_->egl;
  const auto fail = [&](const char* step) {
    *why_not = std::string(step) + " failed (EGL error " + std::to_string(egl.GetError()) + ")";
    return false;
  };
  if (device == kSurfaceless) {
    handles_->display = egl.GetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  } else {
    const std::vector<EGLDeviceEXT> handles = query_devices(egl);
    handles_->display =
        egl.GetPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, handles.at(static_cast<std::size_t>(device)), nullptr);
  }
  if (handles_->display == EGL_NO_DISPLAY) return fail("eglGetPlatformDisplay");
  EGLint major = 0, minor = 0;
  if (egl.Initialize(handles_->display, &major, &minor) != EGL_TRUE) return fail("eglInitialize");
  if (egl.BindAPI(EGL_OPENGL_API) != EGL_TRUE) return fail("desktop OpenGL (eglBindAPI)");
  const EGLint attributes[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (egl.ChooseConfig(handles_->display, attributes, &config, 1, &count) != EGL_TRUE || count < 1)
    return fail("eglChooseConfig");
  handles_->context = egl.CreateContext(handles_->display, config, EGL_NO_CONTEXT, nullptr);
  if (handles_->context == EGL_NO_CONTEXT) return fail("eglCreateContext");
  if (egl.MakeCurrent(handles_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, handles_->context) != EGL_TRUE)
    return fail("eglMakeCurrent");
  return true;
}

void EglContext::close(Handles* handles) {
  if (handles->display == EGL_NO_DISPLAY) return;
  const EglLibrary& egl = *handles->egl;
  if (handles->context != EGL_NO_CONTEXT) {
    egl.MakeCurrent(handles->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    egl.DestroyContext(handles->display, handles->context);
  }
  // The display stays initialised: EGL shares it among all contexts of the process.
  handles->context = EGL_NO_CONTEXT;
  handles->display = EGL_NO_DISPLAY;
}

void EglContext::make_current() const {
  const EglLibrary& egl = *handles_->egl;
  if (egl.GetCurrentContext() == handles_->context) return;
  if (egl.MakeCurrent(handles_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, handles_->context) != EGL_TRUE)
    throw Error("cannot make the OpenGL context current: a renderer must stay in the thread that made it");
}

GlFunctions EglContext::load_functions(const Handles& handles) {
  const EglLibrary& egl = *handles.egl;
  GlFunctions gl{};
  const auto load = [&egl](const char* name, auto* function) {
    load_extension(egl, name, function);
    if (*function == nullptr) throw Error(std::string("the OpenGL driver lacks ") + name + "; " + kInstallEgl);
  };
  load("glGetString", &gl.GetString);
  load("glGetError", &gl.GetError);
  load("glGetIntegerv", &gl.GetIntegerv);
  load("glFinish", &gl.Finish);
  load("glReadPixels", &gl.ReadPixels);
  load("glPixelStorei", &gl.PixelStorei);
  load("glReadBuffer", &gl.ReadBuffer);
  load("glBindTexture", &gl.BindTexture);
  load("glTexParameteri", &gl.TexParameteri);
  load("glTexParameterf", &gl.TexParameterf);
  load("glGetFloatv", &gl.GetFloatv);
  load("glGenerateMipmap", &gl.GenerateMipmap);
  load("glGenFramebuffers", &gl.GenFramebuffers);
  load("glDeleteFramebuffers", &gl.DeleteFramebuffers);
  load("glBindFramebuffer", &gl.BindFramebuffer);
  load("glGenRenderbuffers", &gl.GenRenderbuffers);
  load("glDeleteRenderbuffers", &gl.DeleteRenderbuffers);
  load("glBindRenderbuffer", &gl.BindRenderbuffer);
  load("glRenderbufferStorage", &gl.RenderbufferStorage);
  load("glFramebufferRenderbuffer", &gl.FramebufferRenderbuffer);
  load("glCheckFramebufferStatus", &gl.CheckFramebufferStatus);
  return gl;
}

}  // namespace rigproof
