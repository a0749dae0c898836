#include "rigproof/validate/proof.h"

#include <algorithm>
#include <cmath>

#include "proof_parts.h"
#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/yaml.h"

namespace rigproof {
namespace {

template <typename Cameras>
std::optional<std::size_t> camera_named(const Cameras& cameras, const std::string& name) {
  for (std::size_t i = 0; i < cameras.size(); ++i)
    if (cameras[i].name == name) return i;
  return std::nullopt;
}

void append(const proof_detail::Findings& findings, const std::string& camera, Proof* proof) {
  for (const std::string& problem : findings.problems) proof->problems.push_back(camera + ": " + problem);
  for (const std::string& note : findings.notes) proof->notes.push_back(camera + ": " + note);
}

YamlTree list_of_texts(const std::vector<std::string>& texts) {
  YamlTree list = YamlTree::sequence();
  for (const std::string& text : texts) list.add(YamlTree::text(text));
  return list;
}

YamlTree count_of(std::size_t value) { return YamlTree::integer(static_cast<std::int64_t>(value)); }

YamlTree tree_of(const RealisedDepthNoise& noise) {
  YamlTree tree = YamlTree::inline_map();
  tree.set("z_m", YamlTree::number(noise.z_m));
  tree.set("pixels", count_of(noise.pixels));
  tree.set("stated_sigma_mm", YamlTree::number(noise.stated_sigma_mm));
  tree.set("sigma_mm", YamlTree::number(noise.sigma_mm));
  tree.set("bias_mm", YamlTree::number(noise.bias_mm));
  return tree;
}

YamlTree tree_of(const RealisedImageNoise& noise) {
  YamlTree tree = YamlTree::inline_map();
  tree.set("electrons", YamlTree::number(noise.electrons));
  tree.set("samples", count_of(noise.samples));
  tree.set("stated_sigma_electrons", YamlTree::number(noise.stated_sigma_electrons));
  tree.set("sigma_electrons", YamlTree::number(noise.sigma_electrons));
  return tree;
}

YamlTree tree_of(const CameraProof& camera) {
  YamlTree tree = YamlTree::map();
  tree.set("camera", YamlTree::text(camera.camera));
  tree.set("views", count_of(camera.views));
  tree.set("corners", count_of(camera.corners));
  tree.set("corner_bias_px", YamlTree::numbers({camera.corner_bias_px.x(), camera.corner_bias_px.y()}));
  tree.set("corner_rms_px", YamlTree::numbers({camera.corner_rms_px.x(), camera.corner_rms_px.y()}));
  tree.set("corner_max_px", YamlTree::number(camera.corner_max_px));
  tree.set("corner_bias_limit_px", YamlTree::number(camera.corner_bias_limit_px));
  tree.set("corner_rms_limit_px", YamlTree::number(camera.corner_rms_limit_px));
  tree.set("depth_frames", count_of(camera.depth_frames));
  tree.set("depth_pixels", count_of(camera.depth_pixels));
  tree.set("depth_ground_share", YamlTree::number(camera.depth_ground_share));
  tree.set("depth_bias_mm", YamlTree::number(camera.depth_bias_mm));
  tree.set("depth_rms_mm", YamlTree::number(camera.depth_rms_mm));
  tree.set("depth_max_mm", YamlTree::number(camera.depth_max_mm));
  tree.set("depth_rms_sigmas", YamlTree::number(camera.depth_rms_sigmas));
  tree.set("depth_valid_share", YamlTree::number(camera.depth_valid_share));
  YamlTree& noise = tree.set("depth_noise", YamlTree::sequence());
  for (const RealisedDepthNoise& entry : camera.depth_noise) noise.add(tree_of(entry));
  YamlTree& image_noise = tree.set("image_noise", YamlTree::sequence());
  for (const RealisedImageNoise& entry : camera.image_noise) image_noise.add(tree_of(entry));
  return tree;
}

void read_count(MapReader* reader, const std::string& key, std::size_t* value) {
  reader->require(key, "a count");
  if (const auto number = reader->integer(key, {0.0, 1e15})) *value = static_cast<std::size_t>(*number);
}

void read_number(MapReader* reader, const std::string& key, double* value) {
  reader->require(key, "a number");
  if (const auto number = reader->number(key)) *value = *number;
}

void read_pair(MapReader* reader, const std::string& key, Eigen::Vector2d* value) {
  reader->require(key, "two numbers");
  if (const auto numbers = reader->numbers(key, 2)) *value = {(*numbers)[0], (*numbers)[1]};
}

RealisedDepthNoise read_depth_noise(const YamlTree& tree, const std::string& path, Problems* problems) {
  RealisedDepthNoise noise;
  MapReader reader(tree, path, problems);
  read_number(&reader, "z_m", &noise.z_m);
  read_count(&reader, "pixels", &noise.pixels);
  read_number(&reader, "stated_sigma_mm", &noise.stated_sigma_mm);
  read_number(&reader, "sigma_mm", &noise.sigma_mm);
  read_number(&reader, "bias_mm", &noise.bias_mm);
  reader.finish();
  return noise;
}

RealisedImageNoise read_image_noise(const YamlTree& tree, const std::string& path, Problems* problems) {
  RealisedImageNoise noise;
  MapReader reader(tree, path, problems);
  read_number(&reader, "electrons", &noise.electrons);
  read_count(&reader, "samples", &noise.samples);
  read_number(&reader, "stated_sigma_electrons", &noise.stated_sigma_electrons);
  read_number(&reader, "sigma_electrons", &noise.sigma_electrons);
  reader.finish();
  return noise;
}

CameraProof read_camera(const YamlTree& tree, const std::string& path, Problems* problems) {
  CameraProof camera;
  MapReader reader(tree, path, problems);
  reader.require("camera", "the camera's name");
  camera.camera = reader.text("camera").value_or("");
  read_count(&reader, "views", &camera.views);
  read_count(&reader, "corners", &camera.corners);
  read_pair(&reader, "corner_bias_px", &camera.corner_bias_px);
  read_pair(&reader, "corner_rms_px", &camera.corner_rms_px);
  read_number(&reader, "corner_max_px", &camera.corner_max_px);
  read_number(&reader, "corner_bias_limit_px", &camera.corner_bias_limit_px);
  read_number(&reader, "corner_rms_limit_px", &camera.corner_rms_limit_px);
  read_count(&reader, "depth_frames", &camera.depth_frames);
  read_count(&reader, "depth_pixels", &camera.depth_pixels);
  read_number(&reader, "depth_ground_share", &camera.depth_ground_share);
  read_number(&reader, "depth_bias_mm", &camera.depth_bias_mm);
  read_number(&reader, "depth_rms_mm", &camera.depth_rms_mm);
  read_number(&reader, "depth_max_mm", &camera.depth_max_mm);
  read_number(&reader, "depth_rms_sigmas", &camera.depth_rms_sigmas);
  read_number(&reader, "depth_valid_share", &camera.depth_valid_share);
  reader.require("depth_noise", "a list of distances");
  if (const YamlTree* noise = reader.find("depth_noise"))
    for (const YamlTree& item : noise->items)
      camera.depth_noise.push_back(read_depth_noise(item, reader.path_of("depth_noise"), problems));
  if (const YamlTree* noise = reader.find("image_noise"))
    for (const YamlTree& item : noise->items)
      camera.image_noise.push_back(read_image_noise(item, reader.path_of("image_noise"), problems));
  reader.finish();
  return camera;
}

}  // namespace

Proof prove(const Recording& recording, const Observations& observations, const Truth& truth,
            const ProofOptions& options) {
  Proof proof;
  std::size_t corners = 0;
  for (std::size_t i = 0; i < observations.cameras.size(); ++i) {
    const std::string& name = observations.cameras[i].name;
    const std::optional<std::size_t> camera = camera_named(truth.cameras, name);
    if (!camera) throw Error("camera " + name + " of the observations is not in the truth");
    CameraProof entry;
    entry.camera = name;
    append(proof_detail::prove_corners(observations, truth, i, *camera, options, &entry), name, &proof);
    if (const auto recorded = camera_named(recording.rig.cameras, name)) {
      append(proof_detail::prove_depth(recording, truth, *recorded, *camera, options, &entry), name, &proof);
      append(proof_detail::prove_image(recording, truth, *recorded, *camera, options, &entry), name, &proof);
    }
    corners += entry.corners;
    proof.cameras.push_back(entry);
  }
  if (corners == 0) proof.problems.push_back("no corner of the board was seen by any camera: nothing is proved");
  proof.passed = proof.problems.empty();
  return proof;
}

void save_proof(const Proof& proof, const std::filesystem::path& file) {
  YamlTree tree = YamlTree::map();
  tree.set("passed", YamlTree::boolean(proof.passed));
  tree.set("problems", list_of_texts(proof.problems));
  tree.set("notes", list_of_texts(proof.notes));
  YamlTree& cameras = tree.set("cameras", YamlTree::sequence());
  for (const CameraProof& camera : proof.cameras) cameras.add(tree_of(camera));
  write_file_atomically(file, emit_yaml(tree));
}

Proof load_proof(const std::filesystem::path& file) {
  const YamlTree tree = read_yaml_file(file);
  Problems problems;
  Proof proof;
  MapReader reader(tree, "", &problems);
  reader.require("passed", "true or false");
  proof.passed = reader.boolean("passed").value_or(false);
  proof.problems = reader.texts("problems").value_or(std::vector<std::string>());
  proof.notes = reader.texts("notes").value_or(std::vector<std::string>());
  reader.require("cameras", "a list of cameras");
  if (const YamlTree* cameras = reader.find("cameras")) {
    for (std::size_t i = 0; i < cameras->items.size(); ++i)
      proof.cameras.push_back(read_camera(cameras->items[i], "cameras[" + std::to_string(i) + "]", &problems));
  }
  reader.finish();
  problems.throw_if_any();
  return proof;
}

}  // namespace rigproof
