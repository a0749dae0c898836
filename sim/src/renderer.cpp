#include "rigproof/sim/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "board_region.h"
#include "depth.h"
#include "floor_paint.h"
#include "gl_scene.h"
#include "lens_map.h"
#include "light_sum.h"
#include "rigproof/core/error.h"
#include "sky.h"
#include "sun_shadows.h"
#include "world_impl.h"

namespace rigproof {
namespace {

// A pinhole with square pixels is what GL draws; anything else is resampled from such a picture.
bool is_direct(const Camera& camera) { return camera.lens == Lens::kPinhole && camera.fx_px == camera.fy_px; }

void require_usable(const Camera& camera, const std::string& name) {
  const bool finite = std::isfinite(camera.fx_px) && std::isfinite(camera.fy_px) && std::isfinite(camera.cx_px) &&
                      std::isfinite(camera.cy_px);
  if (camera.width_px < 8 || camera.height_px < 8 || !finite || camera.fx_px <= 0.0 || camera.fy_px <= 0.0)
    throw Error("camera " + name + " cannot be rendered: it needs at least 8x8 px, and fx_px and fy_px above 0");
}

// Frustum of the pixels of a rectangle of a direct camera, each drawn `factor` times as fine.
Frustum frustum_of(const Camera& camera, const PixelRect& rect, int factor) {
  const double f = camera.fx_px;
  Frustum frustum;
  frustum.x_min = (rect.x0 - 0.5 - camera.cx_px) / f;
  frustum.x_max = (rect.x0 + rect.width - 0.5 - camera.cx_px) / f;
  frustum.y_min = (rect.y0 - 0.5 - camera.cy_px) / f;
  frustum.y_max = (rect.y0 + rect.height - 0.5 - camera.cy_px) / f;
  frustum.width = rect.width * factor;
  frustum.height = rect.height * factor;
  return frustum;
}

// A pinhole picture from which another camera's pixels are taken.
struct Source {
  double focal_px = 1.0;
  RayBounds bounds;

  // Whole pixels, with two to spare on every side for blending.
  Frustum frustum() const {
    Frustum out;
    out.width = static_cast<int>(std::ceil((bounds.x_max - bounds.x_min) * focal_px)) + 5;
    out.height = static_cast<int>(std::ceil((bounds.y_max - bounds.y_min) * focal_px)) + 5;
    out.x_min = bounds.x_min - 2.5 / focal_px;
    out.y_min = bounds.y_min - 2.5 / focal_px;
    out.x_max = out.x_min + out.width / focal_px;
    out.y_max = out.y_min + out.height / focal_px;
    return out;
  }
};

// Rays of the pixels of a rectangle, `factor` times as fine, as a table of positions in a source picture.
class RayTable {
 public:
  // Fills in rays; returns false where the lens has none at all.
  bool fill(const LensMap& lens, const PixelRect& rect, int factor) {
    width_ = rect.width * factor;
    height_ = rect.height * factor;
    const auto count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    xs_.resize(count);
    ys_.resize(count);
    line_x_.resize(static_cast<std::size_t>(width_));
    line_y_.resize(static_cast<std::size_t>(width_));
    const double step = 1.0 / factor, first = 0.5 * step - 0.5;
    source_ = Source();
    RayBounds& bounds = source_.bounds;
    bounds.x_min = bounds.y_min = std::numeric_limits<double>::infinity();
    bounds.x_max = bounds.y_max = -bounds.x_min;
    for (int y = 0; y < height_; ++y) {
      lens.rays_of_row(rect.y0 + first + y * step, rect.x0 + first, step, width_, line_x_.data(), line_y_.data());
      for (int x = 0; x < width_; ++x) {
        const auto i = static_cast<std::size_t>(x);
        const double ray_x = line_x_[i], ray_y = line_y_[i];
        row_x(y)[x] = static_cast<float>(ray_x);
        row_y(y)[x] = static_cast<float>(ray_y);
        bounds.x_min = std::min(bounds.x_min, ray_x);  // a NaN never wins
        bounds.x_max = std::max(bounds.x_max, ray_x);
        bounds.y_min = std::min(bounds.y_min, ray_y);
        bounds.y_max = std::max(bounds.y_max, ray_y);
      }
    }
    if (!(bounds.x_min <= bounds.x_max)) return false;
    source_.focal_px = 1.0 / smallest_step();
    return true;
  }

  // Turns rays into pixel positions of a source picture.
  void locate_in(const Source& source) {
    const Frustum frustum = source.frustum();
    const double f = source.focal_px;
    const double shift_x = -frustum.x_min * f - 0.5, shift_y = -frustum.y_min * f - 0.5;
    for (float& x : xs_) x = static_cast<float>(static_cast<double>(x) * f + shift_x);
    for (float& y : ys_) y = static_cast<float>(static_cast<double>(y) * f + shift_y);
  }

  const Source& source() const { return source_; }
  int width() const { return width_; }
  int height() const { return height_; }
  const float* row_x(int y) const { return xs_.data() + offset(y); }
  const float* row_y(int y) const { return ys_.data() + offset(y); }

 private:
  float* row_x(int y) { return xs_.data() + offset(y); }
  float* row_y(int y) { return ys_.data() + offset(y); }
  std::ptrdiff_t offset(int y) const { return static_cast<std::ptrdiff_t>(y) * width_; }

  // Densest sampling, over a sparse set of pixels: the source must not be coarser than this.
  double smallest_step() const {
    constexpr int kStride = 8;
    double smallest = std::numeric_limits<double>::infinity();
    for (int y = 0; y + 1 < height_; y += kStride) {
      const float *x0 = row_x(y), *y0 = row_y(y), *x1 = row_x(y + 1), *y1 = row_y(y + 1);
      for (int x = 0; x + 1 < width_; x += kStride) {
        const float across = std::hypot(x0[x + 1] - x0[x], y0[x + 1] - y0[x]);
        const float down = std::hypot(x1[x] - x0[x], y1[x] - y0[x]);
        if (across > 0.0F) smallest = std::min(smallest, static_cast<double>(across));
        if (down > 0.0F) smallest = std::min(smallest, static_cast<double>(down));
      }
    }
    return smallest;
  }

  int width_ = 0, height_ = 0;
  Source source_;
  std::vector<float> xs_, ys_;
  std::vector<double> line_x_, line_y_;
};

// What rendering of one camera prepares once.
struct CameraPlan {
  Camera camera;
  std::unique_ptr<LensMap> lens;  // none for a direct camera
  RayTable table;                 // of the whole image at 1x
};

CameraPlan plan_camera(const Camera& camera, const std::string& name,
                       const std::optional<LensResidual>& field = std::nullopt) {
  require_usable(camera, name);
  CameraPlan plan;
  plan.camera = camera;
  if (is_direct(camera) && !field) return plan;
  try {
    plan.lens = std::make_unique<LensMap>(camera, field);
  } catch (const Error& error) {
    throw Error("camera " + name + ": " + error.what());
  }
  plan.table.fill(*plan.lens, {0, 0, camera.width_px, camera.height_px}, 1);
  plan.table.locate_in(plan.table.source());
  return plan;
}

PixelRect whole_image(const Camera& camera) { return {0, 0, camera.width_px, camera.height_px}; }

PixelRect rows_of(const PixelRect& rect, const PixelRect& rows) {
  const int top = std::max(rect.y0, rows.y0), bottom = std::min(rect.y0 + rect.height, rows.y0 + rows.height);
  return {rect.x0, top, rect.width, std::max(0, bottom - top)};
}

/// Part of an image that is drawn so many times as fine.
struct FineRegion {
  PixelRect rect;
  int factor = 2;
};

// Pictures of a part are no larger than this [px].
int factor_within(int factor, const PixelRect& rect) {
  constexpr int kLargest = 4096;
  while (factor > 2 && factor * std::max(rect.width, rect.height) > kLargest) factor /= 2;
  return factor;
}

bool is_all(const PixelRect& rect, const PixelRect& all) {
  return rect.width == all.width && rect.height == all.height;
}

bool covers(const std::vector<FineRegion>& regions, const PixelRect& all) {
  return !regions.empty() && is_all(regions.front().rect, all);
}

// When each row of an image is exposed.
class RowTable {
 public:
  RowTable(const Exposure& exposure, const Camera& camera) : width_(camera.width_px) {
    for (int y = 0; y < camera.height_px; ++y) rows_.push_back(parts_of_row(exposure, y, camera.height_px));
  }
  /// Share of the row's exposure that lies in a part.
  double share(int row, std::size_t part) const {
    const RowParts& parts = rows_[static_cast<std::size_t>(row)];
    const bool inside = part >= parts.first && part < parts.first + parts.shares.size();
    return inside ? parts.shares[part - parts.first] : 0.0;
  }
  /// The rows that are exposed in a part: they are neighbours.
  PixelRect rows_of(std::size_t part) const {
    const int height = static_cast<int>(rows_.size());
    int first = 0;
    while (first < height && share(first, part) <= 0.0) ++first;
    int end = first;
    while (end < height && share(end, part) > 0.0) ++end;
    return {0, first, width_, end - first};
  }

 private:
  int width_;
  std::vector<RowParts> rows_;
};

// The frustum of the picture that an image is, or is resampled from, at 1x.
Frustum whole_frustum(const CameraPlan& plan) {
  if (plan.lens) return plan.table.source().frustum();
  return frustum_of(plan.camera, whole_image(plan.camera), 1);
}

}  // namespace

struct Renderer::Impl {
  Impl(World& world_in, const RenderOptions& options_in)
      : world(world_in),
        options(options_in),
        gl(world_in, options_in.device),
        sky(world_in.description().scene, world_in.description().scene_seed),
        shadows(world_in),
        point_spread(options_in.psf_sigma_px),
        reductions{AreaReduction(options_in.psf_sigma_px, 2), AreaReduction(options_in.psf_sigma_px, 4),
                   AreaReduction(options_in.psf_sigma_px, 8)} {
    for (const WorldCamera& camera : world.description().cameras) {
      plans.push_back(plan_camera(camera.camera, camera.name, camera.lens_residual));
      depth_plans.emplace_back();
      if (camera.depth_camera) depth_plans.back() = plan_camera(camera.depth_camera->camera, camera.name + " (depth)");
    }
  }

  void render(const CameraPlan& plan, const Rigid3& T_world_camera, bool with_ceiling, bool with_depth,
              RenderedView* view);
  void render_depth_camera(std::size_t camera, RenderedView* view);
  void look_from(const Rigid3& T_world_camera, bool with_ceiling);
  void render_color_rows(const CameraPlan& plan, const Rigid3& T_world_camera, const PixelRect& rows, Image8* color);
  void expose_color(std::size_t camera, const Exposure& exposure, Image8* color);
  void expose_depth(std::size_t camera, const Exposure& exposure, RenderedView* view);
  void draw_frame(const CameraPlan& plan, Pass pass);
  RgbaView read_picture(const Frustum& frustum);
  void take_color(const CameraPlan& plan, Image8* color);
  void take_depth(const CameraPlan& plan, ImageF* depth_m);
  void take_object_ids(const CameraPlan& plan, Image16* ids);
  void refine(const CameraPlan& plan, const FineRegion& region, Image8* color);
  RgbaView resampled(const RgbaView& source, const RayTable& table);
  std::vector<FineRegion> fine_regions(const CameraPlan& plan, const Rigid3& T_world_camera,
                                       const PixelRect& within) const;

  World& world;
  RenderOptions options;
  GlScene gl;
  Sky sky;
  SunShadows shadows;
  Rigid3 T_world_eye;  // of the picture that is being drawn
  PointSpread point_spread;
  std::array<AreaReduction, 3> reductions;  // of 2x, 4x and 8x
  std::vector<CameraPlan> plans;
  std::vector<std::optional<CameraPlan>> depth_plans;  // where depth has a camera of its own
  RayTable region_table;
  std::vector<std::uint8_t> resampled_pixels;
  Image8 imager_color, part_color;  // scratch
};

// Of rows of the image. Where a board takes all of these, its region is the only one; where everything is fine anyway,
// the whole comes first, and boards that are drawn finer after it.
std::vector<FineRegion> Renderer::Impl::fine_regions(const CameraPlan& plan, const Rigid3& T_world_camera,
                                                     const PixelRect& within) const {
  std::vector<FineRegion> regions;
  if (options.whole_at_double) regions.push_back({within});
  const WorldDescription& description = world.description();
  for (std::size_t i = 0; options.board_at_double && i < description.boards(); ++i) {
    const WorldBoard& board = description.board_at(i);
    const Rigid3 T_camera_board = T_world_camera.inverse() * board.T_world_board;
    FineRegion region{rows_of(board_region(plan.camera, T_camera_board, board.board, board.board_margin_m), within)};
    if (region.rect.empty()) continue;
    region.factor = factor_within(board_refinement(plan.camera, T_camera_board, board.board), region.rect);
    if (options.whole_at_double && region.factor == 2) continue;
    if (is_all(region.rect, within)) return {region};
    regions.push_back(region);
  }
  return regions;
}

void Renderer::Impl::draw_frame(const CameraPlan& plan, Pass pass) { gl.draw(whole_frustum(plan), pass); }

RgbaView Renderer::Impl::read_picture(const Frustum& frustum) {
  const RgbaView picture = gl.read_color();
  sky.paint(frustum, T_world_eye.rotation_matrix(), gl.color_rows_from_bottom());
  if (shadows.exist())
    shadows.paint(frustum, T_world_eye, gl.read_depth(), gl.depth_law(), gl.color_rows_from_bottom());
  return picture;
}

RgbaView Renderer::Impl::resampled(const RgbaView& source, const RayTable& table) {
  const std::ptrdiff_t row_bytes = static_cast<std::ptrdiff_t>(table.width()) * 4;
  resampled_pixels.resize(static_cast<std::size_t>(row_bytes * table.height()));
  for (int y = 0; y < table.height(); ++y)
    sample_row(source, table.row_x(y), table.row_y(y), table.width(), resampled_pixels.data() + y * row_bytes);
  return {resampled_pixels.data(), row_bytes, table.width(), table.height()};
}

void Renderer::Impl::take_color(const CameraPlan& plan, Image8* color) {
  const RgbaView picture = read_picture(whole_frustum(plan));
  point_spread.apply(plan.lens ? resampled(picture, plan.table) : picture, color);
}

void Renderer::Impl::take_depth(const CameraPlan& plan, ImageF* depth_m) {
  const std::uint32_t* pixels = gl.read_depth();
  if (!world.impl().has_relief())
    lay_paint_on_floor(whole_frustum(plan), T_world_eye, gl.depth_law(), gl.depth_rows_from_bottom());
  const Camera& camera = plan.camera;
  if (!plan.lens) {
    convert_depth({pixels, camera.width_px, camera.height_px}, gl.depth_law(), depth_m);
    return;
  }
  const Frustum frustum = plan.table.source().frustum();
  resize(camera.width_px, camera.height_px, 1, depth_m);
  for (int y = 0; y < camera.height_px; ++y)
    sample_depth_row({pixels, frustum.width, frustum.height}, gl.depth_law(), plan.table.row_x(y), plan.table.row_y(y),
                     camera.width_px, depth_m->row(y));
}

void Renderer::Impl::take_object_ids(const CameraPlan& plan, Image16* ids) {
  const RgbaView picture = gl.read_color();
  const Camera& camera = plan.camera;
  *ids = Image16(camera.width_px, camera.height_px);
  const std::vector<std::uint16_t>& objects = gl.object_of_segment();
  for (int y = 0; y < camera.height_px; ++y) {
    for (int x = 0; x < camera.width_px; ++x) {
      int source_x = x, source_y = y;
      if (plan.lens) {
        const float u = plan.table.row_x(y)[x] + 0.5F, v = plan.table.row_y(y)[x] + 0.5F;
        if (!(u >= 0.0F && v >= 0.0F)) continue;
        source_x = static_cast<int>(u);
        source_y = static_cast<int>(v);
        if (source_x >= picture.width || source_y >= picture.height) continue;
      }
      const std::uint8_t* p = picture.row(source_y) + 4 * source_x;
      const std::size_t segment = static_cast<std::size_t>(p[0] | (p[1] << 8) | (p[2] << 16));
      ids->at(x, y) = segment < objects.size() ? objects[segment] : std::uint16_t{0};
    }
  }
}

// Draws a region finely, lens and PSF applied there, and puts it into the image.
void Renderer::Impl::refine(const CameraPlan& plan, const FineRegion& region, Image8* color) {
  const auto& [rect, factor] = region;
  AreaReduction& reduction = reductions[factor == 2 ? 0 : factor == 4 ? 1 : 2];
  const int margin = reduction.margin_px();
  const PixelRect wide = {rect.x0 - margin, rect.y0 - margin, rect.width + 2 * margin, rect.height + 2 * margin};
  if (plan.lens && !region_table.fill(*plan.lens, wide, factor)) return;
  if (plan.lens) region_table.locate_in(region_table.source());
  const Frustum frustum = plan.lens ? region_table.source().frustum() : frustum_of(plan.camera, wide, factor);
  gl.draw(frustum, Pass::kColor);
  const RgbaView picture = read_picture(frustum);
  reduction.apply(plan.lens ? resampled(picture, region_table) : picture, rect, color);
}

void Renderer::Impl::look_from(const Rigid3& T_world_camera, bool with_ceiling) {
  gl.look_from(T_world_camera, with_ceiling);
  T_world_eye = T_world_camera;
  shadows.follow_robot(world);
}

void Renderer::Impl::render(const CameraPlan& plan, const Rigid3& T_world_camera, bool with_ceiling, bool with_depth,
                            RenderedView* view) {
  const Camera& camera = plan.camera;
  look_from(T_world_camera, with_ceiling);
  const PixelRect whole = whole_image(camera);
  std::vector<FineRegion> regions;
  if (options.color) regions = fine_regions(plan, T_world_camera, whole);
  const bool color_at_single = options.color && !covers(regions, whole);
  if (color_at_single || with_depth) draw_frame(plan, Pass::kColor);
  if (color_at_single) take_color(plan, &view->color);
  if (with_depth) take_depth(plan, &view->depth_m);
  if (options.color) {
    resize(camera.width_px, camera.height_px, 3, &view->color);
    for (const FineRegion& region : regions) refine(plan, region, &view->color);
  }
  if (options.object_ids) {
    draw_frame(plan, Pass::kObjectIds);
    take_object_ids(plan, &view->object_ids);
  }
}

// Depth, and what the imager sees that measures it.
void Renderer::Impl::render_depth_camera(std::size_t camera, RenderedView* view) {
  const CameraPlan& plan = *depth_plans[camera];
  look_from(world.T_world_camera(camera) * world.description().cameras[camera].depth_camera->T_color_depth, true);
  draw_frame(plan, Pass::kColor);
  take_color(plan, &imager_color);
  take_depth(plan, &view->depth_m);
  resize(plan.camera.width_px, plan.camera.height_px, 1, &view->imager);
  for (std::size_t i = 0; i < view->imager.pixels.size(); ++i) view->imager.pixels[i] = imager_color.pixels[3 * i + 1];
}

// Some rows of what render() draws; the rest of `color` stays.
void Renderer::Impl::render_color_rows(const CameraPlan& plan, const Rigid3& T_world_camera, const PixelRect& rows,
                                       Image8* color) {
  look_from(T_world_camera, true);
  const std::vector<FineRegion> regions = fine_regions(plan, T_world_camera, rows);
  if (!covers(regions, rows)) {
    // Blur reaches beyond the rows that are wanted.
    const int margin = point_spread.reach_px();
    const PixelRect with_margin = {0, rows.y0 - margin, rows.width, rows.height + 2 * margin};
    const PixelRect whole = whole_image(plan.camera);
    const PixelRect drawn = plan.lens ? whole : rows_of(with_margin, whole);
    const Frustum frustum = plan.lens ? whole_frustum(plan) : frustum_of(plan.camera, drawn, 1);
    gl.draw(frustum, Pass::kColor);
    const RgbaView picture = read_picture(frustum);
    point_spread.apply(plan.lens ? resampled(picture, plan.table) : picture, &part_color);
    for (int y = rows.y0; y < rows.y0 + rows.height; ++y)
      std::copy_n(part_color.row(y - drawn.y0), part_color.row_length(), color->row(y));
  }
  for (const FineRegion& region : regions) refine(plan, region, color);
}

void Renderer::Impl::expose_color(std::size_t camera, const Exposure& exposure, Image8* color) {
  const CameraPlan& plan = plans[camera];
  const int width = plan.camera.width_px, height = plan.camera.height_px;
  const RowTable table(exposure, plan.camera);
  LightSum light(width, height, 3, exposure.gamma);
  resize(width, height, 3, color);
  for (std::size_t part = 0; part < exposure.parts(); ++part) {
    const PixelRect rows = table.rows_of(part);
    if (rows.empty()) continue;
    world.place_robot(exposure.T_world_robot[part]);
    render_color_rows(plan, world.T_world_camera(camera), rows, color);
    for (int y = rows.y0; y < rows.y0 + rows.height; ++y) light.add_row(y, table.share(y, part), color->row(y));
  }
  light.write(color);
}

// Each row at its own time: pictures of the whole, of which every row is taken once.
void Renderer::Impl::expose_depth(std::size_t camera, const Exposure& exposure, RenderedView* view) {
  const bool own_camera = depth_plans[camera].has_value();
  const CameraPlan& plan = own_camera ? *depth_plans[camera] : plans[camera];
  const RowTable table(exposure, plan.camera);
  ImageF depth(plan.camera.width_px, plan.camera.height_px);
  Image8 imager(own_camera ? plan.camera.width_px : 0, own_camera ? plan.camera.height_px : 0);
  for (std::size_t part = 0; part < exposure.parts(); ++part) {
    const PixelRect rows = table.rows_of(part);
    if (rows.empty()) continue;
    world.place_robot(exposure.T_world_robot[part]);
    if (own_camera) {
      render_depth_camera(camera, view);
    } else {
      look_from(world.T_world_camera(camera), true);
      draw_frame(plan, Pass::kColor);
      take_depth(plan, &view->depth_m);
    }
    for (int y = rows.y0; y < rows.y0 + rows.height; ++y) {
      std::copy_n(view->depth_m.row(y), view->depth_m.row_length(), depth.row(y));
      if (own_camera) std::copy_n(view->imager.row(y), view->imager.row_length(), imager.row(y));
    }
  }
  view->depth_m = std::move(depth);
  view->imager = std::move(imager);
}

Renderer::Renderer(World& world, const RenderOptions& options) {
  if (!(options.psf_sigma_px >= 0.0 && options.psf_sigma_px <= 3.0))
    throw Error("psf_sigma_px: " + std::to_string(options.psf_sigma_px) + ": allowed are 0 to 3 px");
  impl_ = std::make_unique<Impl>(world, options);
}
Renderer::~Renderer() = default;

void Renderer::render(std::size_t camera, RenderedView* view) {
  Impl& r = *impl_;
  const bool own_depth = r.options.depth && r.depth_plans.at(camera).has_value();
  r.render(r.plans[camera], r.world.T_world_camera(camera), true, r.options.depth && !own_depth, view);
  if (own_depth)
    r.render_depth_camera(camera, view);
  else
    view->imager = Image8();
}

void Renderer::render_moving(std::size_t camera, const Exposure& color, const Exposure& depth, RenderedView* view) {
  if (depth.exposure_s > 0.0 && depth.parts() > 1) throw Error("depth is taken at one time in each row: exposure_s 0");
  Impl& r = *impl_;
  if (color.parts() == 1 && depth.parts() == 1) {
    r.world.place_robot(color.T_world_robot.front());
    return render(camera, view);
  }
  if (r.options.depth) r.expose_depth(camera, depth, view);
  if (r.options.color) r.expose_color(camera, color, &view->color);
}

void Renderer::render_from(const Rigid3& T_world_camera, const Camera& camera, bool with_ceiling, RenderedView* view) {
  impl_->render(plan_camera(camera, "without a name"), T_world_camera, with_ceiling, impl_->options.depth, view);
}

void Renderer::render_bare(std::size_t camera) {
  const CameraPlan& plan = impl_->plans.at(camera);
  GlScene& gl = impl_->gl;
  const Rigid3 T_world_camera = impl_->world.T_world_camera(camera);
  gl.look_from(T_world_camera);
  impl_->draw_frame(plan, Pass::kColor);
  if (impl_->options.color) gl.read_color();
  if (impl_->options.depth) gl.read_depth();
  if (impl_->options.color) {  // for a lens: as many pixels of about the same things
    for (const FineRegion& region : impl_->fine_regions(plan, T_world_camera, whole_image(plan.camera))) {
      gl.draw(frustum_of(plan.camera, region.rect, region.factor), Pass::kColor);
      gl.read_color();
    }
  }
  if (impl_->options.object_ids) {
    impl_->draw_frame(plan, Pass::kObjectIds);
    gl.read_color();
  }
}

const std::string& Renderer::gl_renderer() const { return impl_->gl.context().renderer(); }
const std::string& Renderer::gl_version() const { return impl_->gl.context().version(); }

}  // namespace rigproof
