// MEMROC as the authors' program computes it. What looks like a mistake here is one of theirs, and tested as such.
#include "memroc_chain.h"
#include "reference_planes.h"
#include "rigproof/calib/diagnose/method.h"

namespace rigproof {
namespace {

// MEMROC as the authors' program computes it, from the images and clouds on, with its known failures: corners of
// OpenCV's search, a start that takes the board's axes for the robot's, rotations compared as rotation vectors,
// consecutive stops only, heights of the first stop never read, and any level plane taken for the ground, a ceiling
// too. Where there is no recording the observed corners and planes are taken.
class MemrocReference : public Method {
 public:
  explicit MemrocReference(bool joint) : joint_(joint) {}

  MethodTraits traits() const override {
    const std::string gives = "camera to robot (6), camera to camera";
    const std::string needs = "board, odometry, depth or clouds; every camera at two stops in a row";
    if (joint_)
      return {"joint_memroc_reference",
              "Joint-MEMROC as its authors' program computes it, known failures included",
              needs,
              gives,
              MethodReads::kFiles,
              6e-4};
    return {"memroc_reference",
            "MEMROC as its authors' program computes it, known failures included",
            needs,
            gives,
            MethodReads::kFiles,
            4e-4};
  }
  std::optional<Finding> why_not(const MethodInput& input) const override {
    const bool has_height = input.recording == nullptr ? !input.observations.ground_planes.empty()
                                                       : rivals::has_clouds(input.observations, *input.recording);
    if (has_height) return {};
    return Finding("method.no_depth");
  }
  Result solve(const Observations& observations) const override { return solve_recording({observations}); }
  Result solve_recording(const MethodInput& input) const override {
    Result result = rivals::solve_chain(input, joint_, rivals::ChainLink::kNone);
    result.method = traits().name;
    return result;
  }

 private:
  bool joint_;
};

}  // namespace

std::vector<const Method*> memroc_reference_methods() {
  static const MemrocReference alone(false), joint(true);
  return {&alone, &joint};
}

}  // namespace rigproof
