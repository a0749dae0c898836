#include "gl_scene.h"

#include <algorithm>
#include <string>

#include "board_model.h"
#include "rigproof/core/error.h"
#include "world_impl.h"

namespace rigproof {
namespace {

constexpr int kMaxGeoms = 20000;
// Targets grow in steps, so that boards of slightly different sizes do not reallocate them.
constexpr int kSizeStep = 256;

void set_vector(float* out, const Eigen::Vector3d& in) {
  for (int i = 0; i < 3; ++i) out[i] = static_cast<float>(in[i]);
}

void shift_by(const Eigen::Vector3d& camera, float* position) {
  for (int i = 0; i < 3; ++i) position[i] = static_cast<float>(static_cast<double>(position[i]) - camera[i]);
}

int rounded_up(int size) { return (size + kSizeStep - 1) / kSizeStep * kSizeStep; }

// The board whose texture it is; null: none.
const Board* board_of_texture(const World& world, const mjModel* model, int texture) {
  const char* name = mj_id2name(model, mjOBJ_TEXTURE, texture);
  const std::optional<std::size_t> index = name != nullptr ? board_of_name(name) : std::nullopt;
  return index ? &world.description().board_at(*index).board : nullptr;
}

// Anisotropic filtering keeps a checkerboard's edges where they are when it is seen obliquely. On the floor it would
// only cost time. Mesa's software (22.3) moves the edges of markers by up to a fiftieth of a square, in one row of a
// board and not in the next: boards with markers are drawn finer instead, see board_refinement().
void tune_textures(const GlFunctions& gl, const World& world, const mjModel* model, const mjrContext& buffers) {
  GLfloat most = 1.0F;
  gl.GetFloatv(GL_MAX_TEXTURE_MAX_ANISOTROPY_EXT, &most);
  gl.GetError();  // a driver without the extension says "invalid enum"
  for (int i = 0; i < model->ntex; ++i) {
    if (model->tex_type[i] != mjTEXTURE_2D) continue;
    gl.BindTexture(GL_TEXTURE_2D, buffers.texture[i]);
    gl.GenerateMipmap(GL_TEXTURE_2D);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    const Board* board = board_of_texture(world, model, i);
    if (board == nullptr) continue;
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    if (most > 1.0F && board->type == "checkerboard")
      gl.TexParameterf(GL_TEXTURE_2D, GL_TEXTURE_MAX_ANISOTROPY_EXT, std::min(most, 16.0F));
  }
  gl.BindTexture(GL_TEXTURE_2D, 0);
}

void release(const GlFunctions& gl, const RenderTarget& target) {
  if (target.framebuffer != 0) gl.DeleteFramebuffers(1, &target.framebuffer);
  if (target.color != 0) gl.DeleteRenderbuffers(1, &target.color);
  if (target.depth != 0) gl.DeleteRenderbuffers(1, &target.depth);
}

std::vector<std::uint16_t> objects_of_segments(const mjvScene& scene) {
  std::vector<std::uint16_t> objects(static_cast<std::size_t>(scene.ngeom) + 1, 0);
  for (int i = 0; i < scene.ngeom; ++i) {
    const mjvGeom& geom = scene.geoms[i];
    if (geom.segid < 0 || geom.segid >= scene.ngeom || geom.objtype != mjOBJ_GEOM) continue;
    objects[static_cast<std::size_t>(geom.segid) + 1] = static_cast<std::uint16_t>(geom.objid + 1);
  }
  return objects;
}

}  // namespace

GlScene::GlScene(World& world, int device)
    : context_(device),
      world_(world),
      depth_law_(mujoco::depth_law(world.description().scene.near_m, world.description().scene.far_m)) {
  const mjModel* model = world_.impl().model.get();
  mujoco::install_handlers();
  mjv_defaultScene(&scene_);
  mjr_defaultContext(&buffers_);
  mjv_defaultOption(&visible_);
  std::fill(std::begin(visible_.geomgroup), std::end(visible_.geomgroup), mjtByte{1});
  if (world_.impl().has_relief()) visible_.geomgroup[kFlatFloorGroup] = 0;
  mjv_makeScene(model, &scene_, std::min(kMaxGeoms, model->ngeom + 100));
  mjr_makeContext(model, &buffers_, mjFONTSCALE_100);
  mjr_setBuffer(mjFB_OFFSCREEN, &buffers_);
  if (buffers_.currentBuffer != mjFB_OFFSCREEN)
    throw Error("the OpenGL driver (" + context_.renderer() + ") gives no off-screen buffer");
  own_framebuffer_ = buffers_.offFBO;
  context_.gl().GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &max_size_);
  std::fill(std::begin(scene_.flags), std::end(scene_.flags), mjtByte{0});
  scene_.flags[mjRND_CULL_FACE] = 1;
  tune_textures(context_.gl(), world_, model, buffers_);
}

GlScene::~GlScene() {
  context_.make_current();
  release(context_.gl(), target_);
  buffers_.offFBO = own_framebuffer_;
  mjr_freeContext(&buffers_);
  mjv_freeScene(&scene_);
}

void GlScene::make_targets(int width, int height) {
  if (width <= target_.width && height <= target_.height) return;
  const int new_width = std::max(rounded_up(width), target_.width);
  const int new_height = std::max(rounded_up(height), target_.height);
  if (new_width > max_size_ || new_height > max_size_)
    throw Error("a picture of " + std::to_string(width) + "x" + std::to_string(height) +
                " px is larger than the OpenGL driver allows (" + std::to_string(max_size_) + " px a side)");
  const GlFunctions& gl = context_.gl();
  release(gl, target_);
  target_ = RenderTarget();
  gl.GenFramebuffers(1, &target_.framebuffer);
  gl.GenRenderbuffers(1, &target_.color);
  gl.GenRenderbuffers(1, &target_.depth);
  gl.BindRenderbuffer(GL_RENDERBUFFER, target_.color);
  gl.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, new_width, new_height);
  gl.BindRenderbuffer(GL_RENDERBUFFER, target_.depth);
  gl.RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH24_STENCIL8, new_width, new_height);
  gl.BindFramebuffer(GL_FRAMEBUFFER, target_.framebuffer);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target_.color);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER, target_.depth);
  if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw Error("the OpenGL driver (" + context_.renderer() + ") refuses an off-screen buffer of " +
                std::to_string(new_width) + "x" + std::to_string(new_height) + " px with 24-bit depth");
  target_.width = new_width;
  target_.height = new_height;
}

void GlScene::look_from(const Rigid3& T_world_camera, bool with_ceiling) {
  context_.make_current();
  World::Impl& world = world_.impl();
  visible_.geomgroup[kCeilingGroup] = with_ceiling;
  mjvCamera any_camera;
  mjv_defaultCamera(&any_camera);
  mjv_updateScene(world.model.get(), world.data.get(), &visible_, nullptr, &any_camera, mjCAT_ALL, &scene_);
  centre_on(T_world_camera.translation);
  const Eigen::Matrix3d R = T_world_camera.rotation_matrix();
  for (mjvGLCamera& eye : scene_.camera) {
    set_vector(eye.pos, Eigen::Vector3d::Zero());
    set_vector(eye.forward, R.col(2));
    set_vector(eye.up, -R.col(1));
  }
  object_of_segment_ = objects_of_segments(scene_);
}

// Puts the camera into the origin: single precision is finest there, and GL's matrices are single.
void GlScene::centre_on(const Eigen::Vector3d& camera) {
  for (int i = 0; i < scene_.ngeom; ++i) shift_by(camera, scene_.geoms[i].pos);
  for (int i = 0; i < scene_.nlight; ++i) shift_by(camera, scene_.lights[i].pos);
}

void GlScene::draw(const Frustum& frustum, Pass pass) {
  const SceneDescription& description = world_.description().scene;
  const double near = description.near_m;
  make_targets(frustum.width, frustum.height);
  mujoco::set_frustum(&scene_, near * frustum.x_min, near * frustum.x_max, -near * frustum.y_max, -near * frustum.y_min,
                      near, description.far_m);
  scene_.flags[mjRND_SEGMENT] = scene_.flags[mjRND_IDCOLOR] = pass == Pass::kObjectIds;
  buffers_.offFBO = target_.framebuffer;
  buffers_.offWidth = target_.width;
  buffers_.offHeight = target_.height;
  mjr_setBuffer(mjFB_OFFSCREEN, &buffers_);
  mjr_render({0, 0, frustum.width, frustum.height}, &scene_, &buffers_);
  last_ = frustum;
}

RgbaView GlScene::read_color() {
  const GlFunctions& gl = context_.gl();
  const std::size_t row_bytes = static_cast<std::size_t>(last_.width) * 4;
  color_pixels_.resize(std::max(color_pixels_.size(), row_bytes * static_cast<std::size_t>(last_.height)));
  gl.PixelStorei(GL_PACK_ALIGNMENT, 4);
  gl.ReadBuffer(GL_COLOR_ATTACHMENT0);
  gl.ReadPixels(0, 0, last_.width, last_.height, GL_RGBA, GL_UNSIGNED_BYTE, color_pixels_.data());
  RgbaView view;
  view.top = color_pixels_.data() + row_bytes * static_cast<std::size_t>(last_.height - 1);
  view.stride = -static_cast<std::ptrdiff_t>(row_bytes);
  view.width = last_.width;
  view.height = last_.height;
  return view;
}

const std::uint32_t* GlScene::read_depth() {
  const std::size_t count = static_cast<std::size_t>(last_.width) * static_cast<std::size_t>(last_.height);
  depth_pixels_.resize(std::max(depth_pixels_.size(), count));
  context_.gl().ReadPixels(0, 0, last_.width, last_.height, GL_DEPTH_STENCIL, GL_UNSIGNED_INT_24_8,
                           depth_pixels_.data());
  return depth_pixels_.data();
}

void GlScene::finish() const { context_.gl().Finish(); }

}  // namespace rigproof
