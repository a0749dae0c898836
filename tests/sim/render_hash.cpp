// Prints the SHA-256 of one rendered frame, for comparing processes.
#include <cstdio>
#include <string>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/sim/models.h"
#include "rigproof/sim/renderer.h"

int main() {
  using namespace rigproof;
  try {
    const SceneModel scene = load_scene_model("outdoor_yard");
    const RigModel rig = load_rig_model("husky_1x_d455");
    const Rigid3 T_world_board = place_board(rig.rig.board, scene.board.middle());
    const auto world = World::compose(describe_world(rig, scene, rig.rig.board, T_world_board, 5));
    world->place_robot(planar_pose(2.0, 0.3, 0.1));
    Renderer renderer(*world, RenderOptions());
    RenderedView view;
    renderer.render(0, &view);
    std::string bytes(view.color.pixels.begin(), view.color.pixels.end());
    bytes.append(reinterpret_cast<const char*>(view.depth_m.pixels.data()), view.depth_m.pixels.size() * sizeof(float));
    std::printf("%s\n", sha256_hex(bytes).c_str());
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
