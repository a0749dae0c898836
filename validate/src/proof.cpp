#include "rigproof/validate/proof.h"

#include <algorithm>
#include <cmath>

#include "proof_parts.h"
#include "rigproof/core/error.h"
#include "rigproof/core/fields.h"
#include "rigproof/core/files.h"
#include "rigproof/core/finding_tree.h"

namespace rigproof {
namespace {

void append(const proof_detail::Proved& proved, Proof* proof) {
  const CameraProof& camera = proof->cameras.emplace_back(proved.camera);
  for (const Finding& problem : proved.problems) proof->problems.push_back(problem.of(camera.camera));
  for (const Finding& note : proved.notes) proof->notes.push_back(note.of(camera.camera));
}

void visit_count(FieldVisitor& visitor, const char* key, std::size_t& value, const char* description) {
  visitor.require(key, "a count");
  visitor.field(key, value, description);
}

void visit_pair(FieldVisitor& visitor, const char* key, Eigen::Vector2d& value, const char* description) {
  std::vector<double> pair = {value.x(), value.y()};
  visitor.require(key, "two numbers");
  visitor.field(key, pair, {}, 2, 2, description);
  value = {pair[0], pair[1]};
}

void visit_depth_noise(FieldVisitor& visitor, RealisedDepthNoise& noise) {
  visitor.on_one_line();
  visitor.required("z_m", noise.z_m, {}, "near this distance");
  visit_count(visitor, "pixels", noise.pixels, "that have a measurement");
  visitor.required("stated_sigma_mm", noise.stated_sigma_mm, {}, "by the sensor's law");
  visitor.required("sigma_mm", noise.sigma_mm, {}, "found");
  visitor.required("bias_mm", noise.bias_mm, {}, "median of measured minus expected");
}

void visit_image_noise(FieldVisitor& visitor, RealisedImageNoise& noise) {
  visitor.on_one_line();
  visitor.required("electrons", noise.electrons, {}, "light, the median of the squares");
  visit_count(visitor, "samples", noise.samples, "pixels times colours");
  visitor.required("stated_sigma_electrons", noise.stated_sigma_electrons, {}, "by the sensor's law");
  visitor.required("sigma_electrons", noise.sigma_electrons, {}, "found");
}

void visit_camera_proof(FieldVisitor& visitor, CameraProof& camera) {
  visitor.require("camera", "the camera's name");
  visitor.field("camera", camera.camera, TextChoices{}, "its name");
  visit_count(visitor, "views", camera.views, "images of the board");
  visit_count(visitor, "corners", camera.corners, "in all of them");
  visit_pair(visitor, "corner_bias_px", camera.corner_bias_px, "mean of detected minus projected, along x and y");
  visit_pair(visitor, "corner_rms_px", camera.corner_rms_px, "the same, root mean square");
  visitor.required("corner_max_px", camera.corner_max_px, {}, "largest distance");
  visitor.required("corner_bias_limit_px", camera.corner_bias_limit_px, {}, "what is allowed");
  visitor.required("corner_rms_limit_px", camera.corner_rms_limit_px, {}, "what is allowed");
  visit_count(visitor, "depth_frames", camera.depth_frames, "depth images that were compared");
  visit_count(visitor, "depth_pixels", camera.depth_pixels, "on board and ground");
  visitor.required("depth_ground_share", camera.depth_ground_share, {},
                   "of the pixels whose ray meets the ground: those that show it");
  visitor.required("depth_bias_mm", camera.depth_bias_mm, {}, "mean of measured minus expected");
  visitor.required("depth_rms_mm", camera.depth_rms_mm, {}, "the same, root mean square");
  visitor.required("depth_max_mm", camera.depth_max_mm, {}, "largest difference");
  visitor.required("depth_rms_sigmas", camera.depth_rms_sigmas, {}, "on the board, over the stated noise");
  visitor.required("depth_valid_share", camera.depth_valid_share, {}, "of the pixels on the board: those measured");
  visitor.require("depth_noise", "a list of distances");
  visitor.nested_list("depth_noise", camera.depth_noise, "noise of depth by distance", visit_depth_noise);
  visitor.nested_list("image_noise", camera.image_noise, "noise of images by light", visit_image_noise);
}

void visit_proof(FieldVisitor& visitor, Proof& proof, const Wording& wording) {
  visitor.require("passed", "true or false");
  visitor.field("passed", proof.passed, "whether conventions hold");
  visit_findings(visitor, "problems", proof.problems, Severity::kContradiction, wording, "what does not agree");
  visit_findings(visitor, "notes", proof.notes, Severity::kNote, wording, "what could not be proved");
  visitor.require("cameras", "a list of cameras");
  visitor.nested_list("cameras", proof.cameras, "camera by camera", visit_camera_proof);
}

}  // namespace

Proof prove(const Recording& recording, const Observations& observations, const Truth& truth,
            const ProofOptions& options) {
  Proof proof;
  std::size_t corners = 0;
  if (observations.boards() != truth.boards())
    throw Error(observations.source + ": more_boards: these are " + std::to_string(observations.boards()) +
                " boards, and truth/truth.yaml knows " + std::to_string(truth.boards()) +
                ": observe the recording of the same run");
  for (std::size_t i = 0; i < observations.cameras.size(); ++i) {
    const std::string& name = observations.cameras[i].name;
    const std::optional<std::size_t> camera = proof_detail::camera_named(truth.cameras, name);
    if (!camera) throw Error("camera " + name + " of the observations is not in the truth");
    proof_detail::Proved proved;
    proved.camera.camera = name;
    proved = prove_corners(observations, truth, i, *camera, options, std::move(proved));
    if (const auto recorded = proof_detail::camera_named(recording.rig.cameras, name)) {
      proved = prove_depth(recording, observations, truth, *recorded, *camera, options, std::move(proved));
      proved = prove_image(recording, truth, *recorded, *camera, options, std::move(proved));
    }
    corners += proved.camera.corners;
    append(proved, &proof);
  }
  if (corners == 0) proof.problems.emplace_back("proof.nothing_seen");
  proof.passed = proof.problems.empty();
  return proof;
}

void save_proof(const Proof& proof, const std::filesystem::path& file, const Wording& wording) {
  Proof copy = proof;
  write_file_atomically(file, write_fields([&](FieldVisitor& visitor) { visit_proof(visitor, copy, wording); }));
}

std::string proof_schema() {
  Proof proof;
  return schema_of_fields("Rigproof proof: truth/proof.yaml",
                          [&proof](FieldVisitor& visitor) { visit_proof(visitor, proof, {}); }, {1, false});
}

}  // namespace rigproof
