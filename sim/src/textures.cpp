#include "textures.h"

#include "rigproof/core/error.h"
#include "texture_canvas.h"
#include "texture_file.h"

namespace rigproof {
namespace {

const Painters& all_painters() {
  static const Painters all = [] {
    Painters painters = material_painters();
    painters.insert(indoor_painters().begin(), indoor_painters().end());
    painters.insert(outdoor_painters().begin(), outdoor_painters().end());
    return painters;
  }();
  return all;
}

}  // namespace

const std::vector<std::string>& texture_types() {
  static const std::vector<std::string> types = [] {
    std::vector<std::string> names = {"file"};
    for (const auto& [name, painter] : all_painters()) names.push_back(name);
    return names;
  }();
  return types;
}

std::vector<std::uint8_t> draw_texture(const SceneTexture& texture, std::uint64_t seed) {
  if (texture.type == "file") return load_texture_file(texture.file, texture.size_px);
  const auto painter = all_painters().find(texture.type);
  if (painter == all_painters().end()) {
    std::string choices;
    for (const std::string& type : texture_types()) choices += (choices.empty() ? "" : ", ") + type;
    throw Error("texture " + texture.name + ": type: " + texture.type + ": allowed are " + choices);
  }
  Canvas canvas(texture, seed);
  painter->second(&canvas);
  return canvas.bytes();
}

}  // namespace rigproof
