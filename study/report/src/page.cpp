#include "rigproof/study/report/page.h"

#include <algorithm>
#include <cmath>

#include "drive_poses.h"
#include "inspect_pictures.h"
#include "page_parts.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/text.h"
#include "rigproof/core/version.h"
#include "rigproof/study/workflow/workflow.h"

namespace rigproof {
namespace page_detail {

Json rounded(double value, int decimals) {
  const double scale = std::pow(10.0, decimals);
  return std::isfinite(value) ? Json(std::round(value * scale) / scale) : Json();
}

Json figure_of(double value) {
  return std::isfinite(value) ? Json(parse_number(short_text(value, 8)).value_or(value)) : Json();
}

Json list_of(const Eigen::VectorXd& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(figure_of(value));
  return list;
}

Json pose_of(const Rigid3& T) {
  Eigen::Matrix<double, 7, 1> values;
  values << T.translation, T.rotation.coeffs();
  return list_of(values);
}

namespace {

Json poses_of(const std::vector<Rigid3>& poses) {
  Json list = Json::array();
  for (const Rigid3& T : poses) list.push_back(pose_of(T));
  return list;
}

// Rays through the image's corners, as (x, y) at z = 1; of a lens that has no ray there, those of a pinhole.
Json frustum_of(const Camera& camera) {
  Json list = Json::array();
  for (const auto& [u, v] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)}) {
    const Eigen::Vector2d pixel(u * (camera.width_px - 1.0), v * (camera.height_px - 1.0));
    Eigen::Vector3d ray((pixel.x() - camera.cx_px) / camera.fx_px, (pixel.y() - camera.cy_px) / camera.fy_px, 1.0);
    camera.unproject(pixel, &ray);
    list.push_back({rounded(ray.x(), 5), rounded(ray.y(), 5)});
  }
  return list;
}

Json camera_json(const InspectInput& input, const RigCamera& camera) {
  Json json = {{"name", camera.name}, {"sensor", camera.sensor}, {"link", camera.link}};
  json["width"] = camera.camera.width_px;
  json["height"] = camera.camera.height_px;
  json["focal_px"] = figure_of(camera.camera.fx_px);
  json["lens"] = lens_name(camera.camera.lens);
  json["has_depth"] = camera.depth.has_value();
  json["lens_residual_px"] = figure_of(camera.intrinsics_sigma.residual_px);
  json["frustum"] = frustum_of(camera.camera);
  json["true_pose"] = nullptr;
  if (input.truth)
    if (const auto i = inspect_detail::index_in_truth(*input.truth, camera.name))
      json["true_pose"] = pose_of(input.truth->cameras[*i].T_robot_camera);
  return json;
}

Json board_json(const Board& board) {
  Json json = {{"type", board.type},
               {"squares", {board.squares_x, board.squares_y}},
               {"square_m", figure_of(board.square_m)},
               {"print_sigma_m", figure_of(board.print_sigma())},
               {"outline", Json::array()},
               {"corners", Json::array()}};
  for (const Eigen::Vector3d& p : board.outline()) json["outline"].push_back({figure_of(p.x()), figure_of(p.y())});
  for (const Eigen::Vector3d& p : board.corners()) json["corners"].push_back({figure_of(p.x()), figure_of(p.y())});
  return json;
}

Json drive_json(const InspectInput& input) {
  Json json = {{"driven", Json::array()},
               {"odometry", Json::array()},
               {"board", nullptr},
               {"more_boards", Json::array()},
               {"is_true", false}};
  if (input.observations.stops.empty()) return json;
  const inspect_detail::DrivePoses poses = inspect_detail::drive_poses(input);
  json["driven"] = poses_of(poses.driven);
  json["odometry"] = poses_of(poses.odometry);
  json["is_true"] = input.truth.has_value();
  if (const auto& first = poses.T_world_board.front()) json["board"] = pose_of(*first);
  for (std::size_t b = 1; b < poses.T_world_board.size(); ++b)
    json["more_boards"].push_back(poses.T_world_board[b] ? pose_of(*poses.T_world_board[b]) : Json());
  return json;
}

// Files that tell how the data came about, as they are.
Json texts_of(const InspectInput& input) {
  std::vector<std::filesystem::path> files;
  if (input.input.run) files.push_back(input.input.run->config_file());
  if (input.input.recording) files.push_back(input.input.recording->folder / "rig.yaml");
  Json list = Json::array();
  for (const std::filesystem::path& file : files) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) continue;
    list.push_back({{"name", file.filename().string()}, {"text", read_text_file(file, 1U << 20U)}});
  }
  return list;
}

Json facts_of(const InspectInput& input) {
  Json facts = Json::array();
  const auto add = [&facts](const char* name, const std::string& value) {
    if (!value.empty()) facts.push_back({name, value});
  };
  if (input.truth) {
    add("scene", input.truth->scene);
    add("seed", std::to_string(input.truth->seed));
  }
  add("board", input.observations.board.type);
  for (const Board& board : input.observations.more_boards) add("another board", board.type);
  add("source", input.observations.source);
  add("rigproof", version());
  std::error_code ignored;
  if (input.input.run && std::filesystem::is_regular_file(input.input.run->manifest_file(), ignored)) {
    const Manifest manifest = load_manifest(input.input.run->manifest_file());
    add("generated by", "rigproof " + manifest.tool_version);
    add("MuJoCo", manifest.mujoco_version);
    add("drawn by", manifest.gl_renderer);
  }
  return facts;
}

std::vector<Result> with_first(std::vector<Result> results, const std::string& method) {
  if (results.empty()) throw Error("there is no result to report; make one with: rigproof calibrate");
  if (const std::optional<std::size_t> found = find_result(results, method)) {
    const auto first = results.begin() + static_cast<std::ptrdiff_t>(*found);
    std::rotate(results.begin(), first, first + 1);
  } else if (!method.empty()) {
    std::vector<std::string> known;
    for (const Result& result : results) known.push_back(result.method);
    throw Error("--method " + for_message(method) + ": there is no result of it; " + suggestion(method, known));
  }
  return results;
}

std::string title_of(const InspectInput& input) {
  const std::filesystem::path path = input.input.path.lexically_normal();
  const std::filesystem::path name = path.has_filename() ? path.filename() : path.parent_path().filename();
  return name.empty() || name == "." ? std::filesystem::absolute(path).parent_path().filename().string()
                                     : name.string();
}

}  // namespace

std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace page_detail

PageContent page_content(const InspectInput& input, const PageOptions& options) {
  using namespace page_detail;
  const std::vector<Result> results = with_first(input.results, options.method);
  const std::vector<Frame> frames = frames_of(input.observations, options.max_frames);
  const std::vector<TransformBound> bounds =
      input.truth ? transform_bounds(input.observations, *input.truth) : std::vector<TransformBound>();
  Json data = {{"kind", "calibration"},
               {"version", version()},
               {"title", title_of(input)},
               {"robot_frame", input.observations.robot_frame}};
  data["has_truth"] = input.truth.has_value();
  data["has_images"] = input.input.recording.has_value();
  data["judged_by"] = input.truth ? describe(options.budget) : "";
  data["facts"] = facts_of(input);
  data["texts"] = texts_of(input);
  data["board"] = board_json(input.observations.board);
  for (const Board& board : input.observations.more_boards) data["more_boards"].push_back(board_json(board));
  data["cameras"] = Json::array();
  for (const RigCamera& camera : input.observations.cameras) data["cameras"].push_back(camera_json(input, camera));
  data["drive"] = drive_json(input);
  data["results"] = Json::array();
  for (const Result& result : results) data["results"].push_back(result_json(input, result, frames, bounds, options));
  data["frames"] = frames_json(input, frames);
  return {data["title"], text_of(data), images_json(input, frames, options)};
}

void write_page(const InspectInput& input, const std::filesystem::path& file, const PageOptions& options) {
  write_file_atomically(file, page_html(page_content(input, options)));
}

}  // namespace rigproof
