// Prints how true and how fast rendering is: corner shift and depth error of every camera model over many views, and
// milliseconds per frame against the bare passes.   bench_render [views]
#include <cstdio>
#include <cstdlib>
#include <string>

#include "clocks.h"
#include "render_truth.h"
#include "rigproof/core/error.h"
#include "rigproof/core/random.h"
#include "rigproof/sim/models.h"

namespace rigproof {
namespace {

// Of the process, driver threads included: other people's work on the machine does not count.
double cpu_ms() { return 1e3 * cpu_s(); }

struct Mode {
  const char* name;
  bool board_at_double, whole_at_double;
};

void print_truth(int views) {
  std::printf("%-15s %-9s %7s  %-19s  %-19s  %7s  %-15s  %-15s\n", "camera", "mode", "corners", "rms x y [px]",
              "bias x y [px]", "max", "board max rms", "floor max rms [mm]");
  const auto world = World::compose(figure_world(figure_cameras()));
  const WorldDescription& description = world->description();
  for (const Mode& mode : {Mode{"board 2x", true, false}, Mode{"1x", false, false}, Mode{"all 2x", true, true}}) {
    RenderOptions options;
    options.object_ids = true;
    options.board_at_double = mode.board_at_double;
    options.whole_at_double = mode.whole_at_double;
    Renderer renderer(*world, options);
    for (std::size_t k = 0; k < description.cameras.size(); ++k) {
      const WorldCamera& camera = description.cameras[k];
      RandomStream random(11, "views");
      ShiftStatistics shift;
      DepthStatistics board, floor;
      RenderedView view;
      for (int i = 0; i < views; ++i) {
        const Rigid3 T_world_camera =
            random_view_of_board(camera.camera, description.board, description.T_world_board, &random);
        place_camera(world.get(), k, T_world_camera);
        renderer.render(k, &view);
        const Rigid3 T_camera_board = T_world_camera.inverse() * description.T_world_board;
        for (int corner = 0; corner < description.board.corner_count(); ++corner)
          if (const auto d = corner_shift(view.color, camera.camera, T_camera_board, description.board, corner,
                                          options.psf_sigma_px))
            shift.add(*d);
        add_plane_depth(*world, view, ObjectKind::kBoard, camera.camera, T_camera_board,
                        printed_face(description.board), &board);
        add_plane_depth(*world, view, ObjectKind::kFloor, camera.camera, T_world_camera.inverse(), boundless(), &floor);
      }
      std::printf("%-15s %-9s %7zu  %9.5f %9.5f  %+9.5f %+9.5f  %7.4f  %7.5f %7.5f  %7.5f %7.5f\n", camera.name.c_str(),
                  mode.name, shift.corners, shift.rms_px().x(), shift.rms_px().y(), shift.bias_px().x(),
                  shift.bias_px().y(), shift.largest_px, 1e3 * board.largest_m, 1e3 * board.rms_m(),
                  1e3 * floor.largest_m, 1e3 * floor.rms_m());
    }
  }
}

// One robot place, the rig's cameras in turn; the passes alone against all that render() does.
void print_speed(const std::string& scene_name, const std::string& rig_name, int rounds) {
  const SceneModel scene = load_scene_model(scene_name);
  const RigModel rig = load_rig_model(rig_name);
  const Rigid3 T_world_board = place_board(rig.rig.board, scene.board.middle());
  const auto world = World::compose(describe_world(rig, scene, rig.rig.board, T_world_board, 0));
  world->place_robot(planar_pose(1.5, 0.3, 0.0));
  Renderer renderer(*world, RenderOptions());
  RenderedView view;
  double full = 0.0, bare = 0.0;
  for (int round = -1; round < rounds; ++round) {
    const double start = cpu_ms();
    for (std::size_t k = 0; k < rig.rig.cameras.size(); ++k) renderer.render(k, &view);
    const double middle = cpu_ms();
    for (std::size_t k = 0; k < rig.rig.cameras.size(); ++k) renderer.render_bare(k);
    if (round < 0) continue;  // warms caches and shaders
    full += middle - start;
    bare += cpu_ms() - middle;
  }
  const double frames = static_cast<double>(rig.rig.cameras.size()) * rounds;
  std::printf("%-13s %-22s CPU %6.2f ms a frame, bare passes %6.2f ms, ratio %.3f  (%s)\n", scene_name.c_str(),
              rig_name.c_str(), full / frames, bare / frames, bare / full, renderer.gl_renderer().c_str());
}

}  // namespace
}  // namespace rigproof

int main(int argc, char** argv) {
  try {
    const int views = argc > 1 ? std::atoi(argv[1]) : 60;
    for (const std::string& scene : rigproof::scene_model_names())
      for (const char* rig : {"husky_3x_d455", "cart_5x_mixed"}) rigproof::print_speed(scene, rig, 10);
    rigproof::print_truth(views);
  } catch (const rigproof::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
