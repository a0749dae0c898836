// T_robot_camera of each camera as four rows of four numbers, which numpy.loadtxt reads below each other.
#include "comments.h"
#include "numbers.h"
#include "rigproof/study/export/export.h"

namespace rigproof {
namespace {

ExportOutput write(const ExportJob& job) {
  std::string text = exporting::hash_comment(exporting::head_lines(job));
  for (const ExportCamera& camera : job.cameras) {
    if (!camera.is_known()) continue;
    text += "# " + sentence_of(camera.estimate) + ": p_" + camera.estimate.parent + " = T p_" + camera.name +
            ", metres, optical axes (x right, y down, z forward)\n" +
            exporting::matrix_text(camera.estimate.T_parent_child.matrix());
  }
  return {{{"", text}}, {}};
}

}  // namespace

ExportFormat matrix_export() {
  ExportFormat format;
  format.name = "matrix";
  format.what = "4x4 matrices T_robot_camera of the optical frames, as text";
  format.is_tree = false;
  format.write = write;
  return format;
}

}  // namespace rigproof
