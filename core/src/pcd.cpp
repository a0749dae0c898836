#include "rigproof/core/pcd.h"

namespace rigproof {

std::string encode_pcd(const std::vector<std::array<float, 3>>& points) {
  const std::string count = std::to_string(points.size());
  std::string file =
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n"
      "COUNT 1 1 1\nWIDTH " +
      count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n";
  file.append(reinterpret_cast<const char*>(points.data()), points.size() * sizeof(points[0]));
  return file;
}

}  // namespace rigproof
