// What the document of a report is gathered from, one function a part.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "corner_fit.h"
#include "rigproof/study/report/page.h"
#include "rigproof/validate/bound.h"
#include "rigproof/validate/validate.h"

namespace rigproof::page_detail {

using inspect_detail::CornerFit;
using inspect_detail::fit_corners;
using Json = nlohmann::ordered_json;

/// Rounded, so that the file stays small; null where it is not finite.
Json rounded(double value, int decimals);
/// With eight significant digits: of poses and sigmas.
Json figure_of(double value);
Json list_of(const Eigen::VectorXd& values);
/// [x, y, z, qx, qy, qz, qw].
Json pose_of(const Rigid3& T);

/// Text that is no UTF-8 is replaced.
std::string text_of(const Json& json);

/// An image that is shown: one with the board in it, or one that was left out.
struct Frame {
  int camera = 0;
  int stop = -1;
  std::string file;
  const BoardView* view = nullptr;
  std::optional<Finding> left_out;  ///< by observing
};
/// Those of the observations, by camera and stop; of more than `most` so many, spread evenly.
std::vector<Frame> frames_of(const Observations& observations, std::size_t most);
Json frames_json(const InspectInput& input, const std::vector<Frame>& frames);

/// The pictures of the frames, as PageContent::images has them.
std::string images_json(const InspectInput& input, const std::vector<Frame>& frames, const PageOptions& options);

/// Where the ground plane of the frame's stop was found in its depth: [columns, cells in rows: g ground, o other depth,
/// . none], or null where there is no plane or its depth cannot be read. The recording is there.
std::string ground_json(const InspectInput& input, const Frame& frame);

/// What is said first.
struct PageVerdict {
  std::string level;  ///< good, suspect, bad
  std::string word;   ///< GOOD, SUSPECT, BAD, REFUSED, PARTIAL
  std::string sentence;
  std::vector<std::string> why;
};
/// @param comparison with the truth, if there is one
PageVerdict verdict_of(const Result& result, const std::optional<Comparison>& comparison, const Budget& budget,
                       const Observations& observations, const CornerFit& fit);

/// Code, severity, sentence and what to do.
Json findings_list(const std::vector<Finding>& findings);
/// A pose in the robot: x y z roll pitch yaw of the camera's body axes with their sigmas, and which axes are answered.
Json pose_json(const EstimatedTransform& stated);

/// A result with its verdict.
Json result_json(const InspectInput& input, const Result& result, const std::vector<Frame>& frames,
                 const std::vector<TransformBound>& bounds, const PageOptions& options);

}  // namespace rigproof::page_detail
