#include <cmath>

#include "rigproof/core/conventions.h"
#include "rigproof/core/figures.h"
#include "rigproof/validate/format.h"
#include "rigproof/validate/published.h"
#include "rigproof/validate/text_table.h"
#include "said.h"

namespace rigproof {
namespace {

// Published numbers have two decimals; one's own may be far smaller and get two digits of their own.
std::string own_figure(double value) { return figure(value, std::max(2, decimals_for(value, 2))); }

std::vector<std::string> own_row(const std::string& name, const std::array<double, 6>& values) {
  std::vector<std::string> cells = {name};
  for (const double value : values) cells.push_back(own_figure(value));
  return cells;
}

std::string table_beside(const PublishedTable& published, const std::vector<TransformError>& errors) {
  const auto chart = mean_absolute_error(errors, false), paper = mean_absolute_error(errors, true);
  if (!chart || !paper) return "";
  TextTable table({0});
  table.add(own_row("this result", *chart));
  table.add(own_row("  as roll, pitch, yaw", *paper));
  for (const PublishedRow& row : published.rows) {
    std::vector<std::string> cells = {row.method};
    for (const std::optional<double>& value : row.error) cells.push_back(value ? figure(*value, 2) : "-");
    table.add(cells);
  }
  const std::vector<std::string> gaps = {" ", "  ", "  ", "  ", "    ", "  "};
  return table.text_below(published.title, {{1, "tx ty tz [cm]"}, {4, "rx ry rz [deg]"}}, gaps);
}

std::string pair_text(const Eigen::Vector2d& pair) {
  return signed_figure(pair.x(), 4) + " " + signed_figure(pair.y(), 4);
}

std::string rms_text(const Eigen::Vector2d& rms) { return figure(rms.x(), 4) + " " + figure(rms.y(), 4); }

}  // namespace

std::string format_paper(const Comparison& comparison) {
  std::string text = "mean |error| beside the paper's (10 runs of 100 poses)\n";
  for (const PublishedTable& table : published_tables())
    if (table.synthetic)  // there is a truth to compare with only in simulation
      text += table_beside(table, table.between_cameras ? comparison.camera_to_camera : comparison.camera_to_robot);
  return text;
}

std::string format_proof(const Proof& proof, const Wording& wording) {
  TextTable table({0});
  table.add({"", "views", "corners", "bias u v", "rms u v", "max [px]", "depth pixels", "ground seen", "bias", "rms",
             "max [mm]"});
  for (const CameraProof& camera : proof.cameras) {
    std::vector<std::string> cells = {camera.camera,
                                      std::to_string(camera.views),
                                      std::to_string(camera.corners),
                                      pair_text(camera.corner_bias_px),
                                      rms_text(camera.corner_rms_px),
                                      figure(camera.corner_max_px, 3),
                                      std::to_string(camera.depth_pixels)};
    if (camera.depth_pixels > 0) {
      cells.push_back(std::to_string(std::lround(100.0 * camera.depth_ground_share)) + " %");
      for (const double value : {camera.depth_bias_mm, camera.depth_rms_mm, camera.depth_max_mm})
        cells.push_back(short_figure(value));
    }
    table.add(cells);
  }
  std::string text = table.text({" ", "  "});
  for (const Finding& problem : proof.problems) text += " PROBLEM  " + said(problem, wording) + "\n";
  for (const Finding& note : proof.notes) text += " NOTE  " + said(note, wording) + "\n";
  return text + (proof.passed ? "PROVED  detected corners and measured depth agree with the truth\n"
                              : "NOT PROVED  the data contradict the truth\n");
}

}  // namespace rigproof
