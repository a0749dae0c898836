#include "opencv_text.h"

#include "rigproof/core/text.h"

namespace rigproof {

std::string opencv_matrix(const std::string& name, std::size_t rows, std::size_t columns,
                          const std::vector<double>& values, std::size_t indent) {
  const std::string line = "\n" + std::string(indent + 3, ' ');
  std::string text = std::string(indent, ' ') + name + ": !!opencv-matrix" + line + "rows: " + std::to_string(rows) +
                     line + "cols: " + std::to_string(columns) + line + "dt: d" + line + "data: [";
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string number = number_text(values[i] + 0.0);
    const bool real = number.find_first_of(".e") != std::string::npos;
    text += std::string(i == 0 ? "" : i % columns == 0 ? "," + line + "    " : ", ") + number + (real ? "" : ".");
  }
  return text + "]\n";
}

std::string opencv_lens(const Camera& camera, const std::string& K_name, const std::string& D_name,
                        std::size_t indent) {
  const std::ptrdiff_t count = camera.lens == Lens::kKannalaBrandt ? 4 : 5;
  return opencv_matrix(K_name, 3, 3, {camera.fx_px, 0.0, camera.cx_px, 0.0, camera.fy_px, camera.cy_px, 0.0, 0.0, 1.0},
                       indent) +
         opencv_matrix(D_name, 1, static_cast<std::size_t>(count),
                       {camera.distortion.begin(), camera.distortion.begin() + count}, indent);
}

}  // namespace rigproof
