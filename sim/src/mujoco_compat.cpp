#include "mujoco_compat.h"

#include <array>
#include <cstring>

#include "rigproof/core/error.h"

namespace rigproof::mujoco {
namespace {

[[noreturn]] void throw_error(const char* message) { throw Error(std::string("MuJoCo: ") + message); }
void ignore_warning(const char*) {}

constexpr const char* kMainFile = "rigproof_world.xml";

// MuJoCo's virtual files. The struct of 2.x weighs 2 MB: heap only.
class VirtualFiles {
 public:
  VirtualFiles() : vfs_(std::make_unique<mjVFS>()) { mj_defaultVFS(vfs_.get()); }
  ~VirtualFiles() { mj_deleteVFS(vfs_.get()); }
  VirtualFiles(const VirtualFiles&) = delete;
  VirtualFiles& operator=(const VirtualFiles&) = delete;

  void add(const char* name, const std::string& bytes) {
#if mjVERSION_HEADER >= 300
    mj_addBufferVFS(vfs_.get(), name, bytes.data(), static_cast<int>(bytes.size()));
#else
    // 2.x reads text up to a terminating zero that it expects to find in the buffer.
    if (mj_makeEmptyFileVFS(vfs_.get(), name, static_cast<int>(bytes.size() + 1)) != 0)
      throw Error("MuJoCo: its virtual file system does not take " + std::string(name));
    const int index = mj_findFileVFS(vfs_.get(), name);
    std::memcpy(vfs_->filedata[index], bytes.c_str(), bytes.size() + 1);
#endif
  }
  const mjVFS* get() const { return vfs_.get(); }

 private:
  std::unique_ptr<mjVFS> vfs_;
};

}  // namespace

std::string version() { return mj_versionString(); }

void install_handlers() {
  mju_user_error = throw_error;
  mju_user_warning = ignore_warning;
}

ModelPtr compile(const std::string& xml, const std::filesystem::path& folder, std::string* complaint) {
  install_handlers();
  VirtualFiles files;
  files.add(kMainFile, xml);
  std::array<char, 1024> error{};
  ModelPtr model(mj_loadXML((folder / kMainFile).c_str(), files.get(), error.data(), static_cast<int>(error.size())));
  if (!model && complaint != nullptr) *complaint = error.data();
  return model;
}

std::uint8_t* texture_bytes(mjModel* model, int texture) {
#if mjVERSION_HEADER >= 321
  if (model->tex_nchannel[texture] != 3) return nullptr;
  return model->tex_data + model->tex_adr[texture];
#else
  return model->tex_rgb + model->tex_adr[texture];
#endif
}

double cast_ray(const mjModel* model, const mjData* data, const double origin[3], const double direction[3],
                const mjtByte groups[mjNGROUP], int* geom) {
#if mjVERSION_HEADER >= 3005000
  return mj_ray(model, data, origin, direction, groups, 1, -1, geom, nullptr);
#else
  return mj_ray(model, data, origin, direction, groups, 1, -1, geom);
#endif
}

void set_frustum(mjvScene* scene, double left, double right, double bottom, double top, double near, double far) {
  for (mjvGLCamera& eye : scene->camera) {
    eye.frustum_center = static_cast<float>(0.5 * (left + right));
#if mjVERSION_HEADER >= 300
    eye.frustum_width = static_cast<float>(0.5 * (right - left));
#endif
    eye.frustum_bottom = static_cast<float>(bottom);
    eye.frustum_top = static_cast<float>(top);
    eye.frustum_near = static_cast<float>(near);
    eye.frustum_far = static_cast<float>(far);
  }
}

DepthLaw depth_law(double near, double far) {
  constexpr double kMaxCount = (1 << 24) - 1;
#if mjVERSION_HEADER >= 300
#error "MuJoCo 3 renders reversed 32-bit depth: read GL_DEPTH_COMPONENT as float and invert the law here"
#endif
  return {1.0 / far, (1.0 / near - 1.0 / far) / kMaxCount};
}

}  // namespace rigproof::mujoco
