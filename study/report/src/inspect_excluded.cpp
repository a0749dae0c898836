#include <algorithm>
#include <map>

#include "inspect_pictures.h"
#include "rigproof/words/sentences.h"

namespace rigproof::inspect_detail {
namespace {

constexpr double kThumbWidth = 280.0, kGap = 14.0, kCaption = 40.0, kRow = 22.0;
constexpr std::size_t kColumns = 4, kMaxReasons = 12;

class ExcludedSheet {
 public:
  ExcludedSheet(const InspectInput& input, const InspectOptions& options) : input_(input) {
    for (const Exclusion& exclusion : input.observations.exclusions) {
      ++counts_[words::short_of(exclusion.why)][camera_of(exclusion)];
      all_.push_back(&exclusion);
    }
    // What is shown is spread over all of them.
    const std::size_t wanted = static_cast<std::size_t>(std::max(0, options.max_excluded_views));
    const std::size_t shown = std::min(wanted, all_.size());
    for (std::size_t i = 0; i < shown; ++i) shown_.push_back(all_[i * all_.size() / shown]);
    for (const RigCamera& camera : input.observations.cameras)
      thumb_height_ = std::max(thumb_height_, height_at(kThumbWidth, camera.camera));
  }

  std::filesystem::path save(const std::filesystem::path& file) const {
    const double table = kRow * static_cast<double>(std::min(counts_.size(), kMaxReasons) + 1);
    const double rows = static_cast<double>((shown_.size() + kColumns - 1) / kColumns);
    const double width = 2.0 * kMargin + kColumns * (kThumbWidth + kGap) - kGap;
    Canvas canvas(static_cast<int>(width),
                  static_cast<int>(kTitleHeight + table + rows * (thumb_height_ + kCaption + kGap) + kMargin));
    const double end =
        draw_title(&canvas, "Frames that were left out",
                   std::to_string(all_.size()) + " left out, " + std::to_string(shown_.size()) + " of them shown");
    draw_camera_legend(&canvas, camera_names(input_.observations), end, 32.0);
    draw_counts(&canvas);
    for (std::size_t i = 0; i < shown_.size(); ++i)
      draw_frame(&canvas, *shown_[i],
                 {kMargin + static_cast<double>(i % kColumns) * (kThumbWidth + kGap),
                  kTitleHeight + table + static_cast<double>(i / kColumns) * (thumb_height_ + kCaption + kGap)});
    return canvas.save(file);
  }

 private:
  static std::size_t camera_of(const Exclusion& exclusion) {
    return static_cast<std::size_t>(std::max(0, exclusion.camera));
  }

  void draw_counts(Canvas* canvas) const {
    std::vector<std::pair<std::size_t, std::string>> kinds;
    for (const auto& [kind, by_camera] : counts_) {
      std::size_t total = 0;
      for (const auto& [camera, count] : by_camera) total += count;
      kinds.emplace_back(total, kind);
    }
    std::sort(kinds.rbegin(), kinds.rend());
    kinds.resize(std::min(kinds.size(), kMaxReasons));
    const double per_frame = std::min(12.0, 420.0 / static_cast<double>(std::max<std::size_t>(1, kinds[0].first)));
    double y = kTitleHeight + 8.0;
    for (const auto& [total, kind] : kinds) {
      canvas->text({kMargin, y}, Canvas::shortened(kind, 9.0, 380.0), 9.0, kInk);
      double x = kMargin + 400.0;
      for (const auto& [camera, count] : counts_.at(kind)) {
        const double length = per_frame * static_cast<double>(count);
        canvas->rectangle({x, y - 10.0}, {length, 12.0}, camera_color(camera));
        x += length;
      }
      canvas->text({x + 8.0, y}, std::to_string(total), 9.0, kInk);
      y += kRow;
    }
  }

  void draw_frame(Canvas* canvas, const Exclusion& exclusion, const Eigen::Vector2d& corner) const {
    const RigCamera& camera = input_.observations.cameras[camera_of(exclusion)];
    const Eigen::Vector2d size(kThumbWidth, kThumbWidth * camera.camera.height_px / camera.camera.width_px);
    if (exclusion.file.empty())
      canvas->rectangle(corner, size, kRule.pale(0.5));
    else
      draw_image(input_, exclusion.file, corner, size, canvas);
    canvas->frame(corner, size, camera_color(camera_of(exclusion)), 1.5);
    const std::string where =
        exclusion.file.empty() ? camera.name + ", stop " + std::to_string(exclusion.stop) : exclusion.file;
    canvas->text(corner + Eigen::Vector2d(1.0, size.y() + 15.0), Canvas::shortened(where, 7.5, kThumbWidth), 7.5,
                 kGrey);
    canvas->text(corner + Eigen::Vector2d(1.0, size.y() + 30.0),
                 Canvas::shortened(words::sentence_of(exclusion.why), 8.5, kThumbWidth), 8.5, kInk);
  }

  const InspectInput& input_;
  std::map<std::string, std::map<std::size_t, std::size_t>> counts_;  // by kind and camera
  std::vector<const Exclusion*> all_, shown_;
  double thumb_height_ = 0.0;
};

}  // namespace

Written draw_excluded(const InspectInput& input, const InspectOptions& options, const std::filesystem::path& folder) {
  if (input.observations.exclusions.empty()) return std::nullopt;
  return ExcludedSheet(input, options).save(folder / "excluded.png");
}

}  // namespace rigproof::inspect_detail
