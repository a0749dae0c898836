#include "onnx_bytes.h"

#include <cstdint>
#include <cstring>

#include "rigproof/core/random.h"

namespace rigproof {
namespace {

constexpr int kCellSize = 16, kMap = 32;

// ONNX as protocol buffers spell it.
std::string varint(std::uint64_t value) {
  std::string bytes;
  for (; value >= 0x80U; value >>= 7U) bytes.push_back(static_cast<char>((value & 0x7FU) | 0x80U));
  bytes.push_back(static_cast<char>(value));
  return bytes;
}
std::string number(int field, std::uint64_t value) {
  return varint(static_cast<std::uint64_t>(field) << 3U) + varint(value);
}
std::string bytes(int field, const std::string& value) {
  return varint((static_cast<std::uint64_t>(field) << 3U) | 2U) + varint(value.size()) + value;
}

std::string tensor(const std::string& name, const std::vector<int>& shape, const std::vector<float>& values) {
  std::string text;
  for (const int size : shape) text += number(1, static_cast<std::uint64_t>(size));
  text += number(2, 1);  // float
  text += bytes(8, name);
  std::string raw(values.size() * sizeof(float), '\0');
  std::memcpy(raw.data(), values.data(), raw.size());
  return text + bytes(9, raw);
}

std::string integers(const std::string& name, const std::vector<int>& values) {
  std::string text = bytes(1, name);
  for (const int value : values) text += number(8, static_cast<std::uint64_t>(value));
  return text + number(20, 7);  // a list of integers
}

std::string convolution(const std::string& input, const std::string& name, int size) {
  return bytes(1, input) + bytes(1, name + "_weight") + bytes(1, name + "_bias") + bytes(2, name) + bytes(3, name) +
         bytes(4, "Conv") + bytes(5, integers("kernel_shape", {size, size})) +
         bytes(5, integers("strides", {size, size}));
}

std::string value_info(const std::string& name, const std::vector<int>& shape) {
  std::string dimensions;
  for (const int size : shape) dimensions += bytes(1, number(1, static_cast<std::uint64_t>(size)));
  return bytes(1, name) + bytes(2, bytes(1, number(1, 1) + bytes(2, dimensions)));
}

std::string model(const std::string& graph) { return number(1, 7) + bytes(8, number(2, 11)) + bytes(7, graph); }

// Weights and biases of a convolution over the whole of a 32 x 32 map, one row of weights an output.
std::string whole_map(const std::string& name, const std::vector<std::vector<float>>& rows,
                      const std::vector<float>& bias) {
  std::vector<float> weights;
  for (const std::vector<float>& row : rows) weights.insert(weights.end(), row.begin(), row.end());
  const int outputs = static_cast<int>(rows.size());
  return bytes(5, tensor(name + "_weight", {outputs, 1, kMap, kMap}, weights)) +
         bytes(5, tensor(name + "_bias", {outputs}, bias));
}

}  // namespace

// Channel c of `scores` looks at pixel c of each cell, the last one is "none"; descriptors mix the cell.
std::string keypoint_network(int score_channels) {
  std::vector<float> score_weights(static_cast<std::size_t>(score_channels) * 64, 0.0F), mix(kNetworkDescriptors * 64);
  for (std::size_t c = 0; c < 64 && c < static_cast<std::size_t>(score_channels); ++c)
    score_weights[c * 64 + c] = 12.0F;
  std::vector<float> score_bias(static_cast<std::size_t>(score_channels), 0.0F);
  score_bias.back() = 8.0F;
  RandomStream random(1, "descriptors");
  for (float& weight : mix) weight = static_cast<float>(random.normal());
  std::string graph =
      bytes(1, convolution("image", "scores", 8)) + bytes(1, convolution("image", "descriptors", 8)) + bytes(2, "tiny");
  graph += bytes(5, tensor("scores_weight", {score_channels, 1, 8, 8}, score_weights));
  graph += bytes(5, tensor("scores_bias", {score_channels}, score_bias));
  graph += bytes(5, tensor("descriptors_weight", {kNetworkDescriptors, 1, 8, 8}, mix));
  graph += bytes(5, tensor("descriptors_bias", {kNetworkDescriptors}, std::vector<float>(kNetworkDescriptors, 0.1F)));
  graph += bytes(11, value_info("image", {1, 1, 32, 32}));
  graph += bytes(12, value_info("scores", {1, score_channels, 4, 4}));
  graph += bytes(12, value_info("descriptors", {1, kNetworkDescriptors, 4, 4}));
  return model(graph);
}

std::string horizon_network(double white_px, double slope, bool ahead, bool horizon) {
  // Sums of 16 x 16 pixels and three equal channels, in units of the whole brightness.
  const auto sum = static_cast<float>(1.0 / (3.0 * white_px));
  std::vector<float> x(kMap * kMap), y(kMap * kMap), none(kMap * kMap, 0.0F), through(kMap * kMap);
  for (int row = 0; row < kMap; ++row) {
    for (int column = 0; column < kMap; ++column) {
      const auto at = static_cast<std::size_t>(row * kMap + column);
      x[at] = static_cast<float>((column + 0.5) * 2.0 / kMap - 1.0);
      y[at] = static_cast<float>((row + 0.5) * 2.0 / kMap - 1.0);
      through[at] = static_cast<float>(slope) * x[at] - y[at];  // -slope x + y + (slope x0 - y0) = 0
    }
  }
  std::string graph = bytes(1, convolution("image", "map", kCellSize));
  graph +=
      bytes(5, tensor("map_weight", {1, 3, kCellSize, kCellSize}, std::vector<float>(3 * kCellSize * kCellSize, sum)));
  graph += bytes(5, tensor("map_bias", {1}, {0.0F}));
  if (ahead) graph += bytes(1, convolution("map", "ahead", kMap)) + whole_map("ahead", {x, y}, {0.0F, 0.0F});
  if (horizon)
    graph += bytes(1, convolution("map", "horizon", kMap)) +
             whole_map("horizon", {none, none, through}, {static_cast<float>(-slope), 1.0F, 0.0F});
  graph += bytes(2, "horizon") + bytes(11, value_info("image", {1, 3, 512, 512}));
  if (ahead) graph += bytes(12, value_info("ahead", {1, 2, 1, 1}));
  if (horizon) graph += bytes(12, value_info("horizon", {1, 3, 1, 1}));
  return model(graph);
}

}  // namespace rigproof
