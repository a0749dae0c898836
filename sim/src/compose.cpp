#include <algorithm>

#include "board_model.h"
#include "mjcf_text.h"
#include "rigproof/core/error.h"
#include "scene_objects.h"
#include "world_impl.h"

namespace rigproof {
namespace {

std::string visual(const SceneDescription& scene) {
  // extent = 1: MuJoCo multiplies clip planes by it. Its own shadows stay off: see sun_shadows.h.
  return "<visual>\n  <headlight active=\"0\"/>\n  <quality offsamples=\"0\" shadowsize=\"16\" numslices=\"20\" "
         "numstacks=\"10\" numquads=\"1\"/>\n"
         "  <global offwidth=\"16\" offheight=\"16\"/>\n  <map znear=" +
         quoted(numbers({scene.near_m})) + " zfar=" + quoted(numbers({scene.far_m})) +
         "/>\n</visual>\n<statistic extent=\"1\" center=\"0 0 0\"/>\n";
}

// A pole that carries the board from behind.
std::string stand(const WorldDescription& description) {
  constexpr double kRadius = 0.015;
  Eigen::Vector3d behind = description.board.centre();
  behind.z() = description.board_thickness_m + kRadius;
  const Eigen::Vector3d top = description.T_world_board * behind;
  if (top.z() < 4.0 * kRadius) return {};
  const double foot = std::min(0.0, description.ground.height(top.head<2>()));
  return "  <geom name=\"rigproof_stand\" type=\"cylinder\" size=" + quoted(numbers({kRadius})) +
         " fromto=" + quoted(numbers({top.x(), top.y(), top.z(), top.x(), top.y(), foot})) +
         " rgba=\"0.25 0.25 0.26 1\"/>\n";
}

std::string texture_assets(const SceneDescription& scene) {
  std::string text;
  for (const SceneTexture& texture : scene.textures) {
    text += "  <texture name=" + quoted(texture.name) + (texture.cube ? " type=\"cube\"" : " type=\"2d\"") +
            " builtin=\"flat\" width=" + quoted(std::to_string(texture.size_px)) +
            " height=" + quoted(std::to_string(texture.cube ? 6 * texture.size_px : texture.size_px)) + "/>\n";
  }
  return text;
}

}  // namespace

std::filesystem::path base_folder(const WorldDescription& description) {
  const std::filesystem::path& file = description.robot_mjcf.empty() ? description.scene.mjcf : description.robot_mjcf;
  return std::filesystem::canonical(file).parent_path();
}

std::string compose_mjcf(const WorldDescription& description, const std::string& more_geoms,
                         const std::string& more_assets) {
  const SceneDescription& scene = description.scene;
  const BoardTexture texture = draw_board(description.board, description.board_margin_m);
  const BoardMjcf board = board_mjcf(description.board, description.board_margin_m, description.board_thickness_m,
                                     texture, pose_attributes(description.T_world_board), description.board_defects);
  // MuJoCo reads an included file at the main file's folder + its name, absolute or not.
  const std::filesystem::path folder = base_folder(description);
  const auto include = [&folder](const std::filesystem::path& file) {
    if (file.empty()) return std::string();
    return "<include file=" + quoted(std::filesystem::canonical(file).lexically_relative(folder).string()) + "/>\n";
  };
  const ObjectsMjcf objects = objects_mjcf(scene, description.scene_seed);
  return "<mujoco model=\"rigproof_world\">\n<compiler autolimits=\"true\"/>\n" + visual(scene) + "<asset>\n" +
         texture_assets(scene) + objects.assets + board.asset + more_assets + "</asset>\n" + include(scene.mjcf) +
         include(description.robot_mjcf) + "<worldbody>\n" + objects.bodies + board.body + stand(description) +
         more_geoms + "</worldbody>\n</mujoco>\n";
}

}  // namespace rigproof
