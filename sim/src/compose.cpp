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

// A pole that carries a board from behind.
std::string stand(const WorldBoard& board, const GroundRelief& ground, const std::string& name) {
  constexpr double kRadius = 0.015;
  Eigen::Vector3d behind = board.board.centre();
  behind.z() = board.board_thickness_m + kRadius;
  const Eigen::Vector3d top = board.T_world_board * behind;
  if (top.z() < 4.0 * kRadius) return {};
  const double foot = std::min(0.0, ground.height(top.head<2>()));
  return "  <geom name=" + quoted(name) + " type=\"cylinder\" size=" + quoted(numbers({kRadius})) +
         " fromto=" + quoted(numbers({top.x(), top.y(), top.z(), top.x(), top.y(), foot})) +
         " rgba=\"0.25 0.25 0.26 1\"/>\n";
}

BoardMjcf standing_board(const WorldBoard& board, const GroundRelief& ground, std::size_t index) {
  const BoardTexture texture = draw_board(board.board, board.board_margin_m);
  BoardMjcf mjcf = board_mjcf(board, texture, board_name(index), pose_attributes(board.T_world_board));
  mjcf.body += stand(board, ground, "rigproof_stand" + (index == 0 ? "" : "_" + std::to_string(index + 1)));
  return mjcf;
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
  BoardMjcf boards;
  for (std::size_t i = 0; i < description.boards(); ++i) {
    const BoardMjcf board = standing_board(description.board_at(i), description.ground, i);
    boards.asset += board.asset;
    boards.body += board.body;
  }
  // MuJoCo reads an included file at the main file's folder + its name, absolute or not.
  const std::filesystem::path folder = base_folder(description);
  const auto include = [&folder](const std::filesystem::path& file) {
    if (file.empty()) return std::string();
    return "<include file=" + quoted(std::filesystem::canonical(file).lexically_relative(folder).string()) + "/>\n";
  };
  const ObjectsMjcf objects = objects_mjcf(scene, description.scene_seed);
  return "<mujoco model=\"rigproof_world\">\n<compiler autolimits=\"true\"/>\n" + visual(scene) + "<asset>\n" +
         texture_assets(scene) + objects.assets + boards.asset + more_assets + "</asset>\n" + include(scene.mjcf) +
         include(description.robot_mjcf) + "<worldbody>\n" + objects.bodies + boards.body + more_geoms +
         "</worldbody>\n</mujoco>\n";
}

}  // namespace rigproof
