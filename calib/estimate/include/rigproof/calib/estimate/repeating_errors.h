// Errors that repeat in every image and that no lens or board of few parameters follows: where each corner was
// printed, and two fields over each camera's image, a smooth one and a fine one. They are estimated from the images
// alone, where the board may lie anywhere, and taken out of the corners before anything else; what the data leave of
// them counts as unknowns of the whole problem.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "rigproof/calib/estimate/lens_field.h"
#include "rigproof/calib/estimate/unknowns.h"
#include "rigproof/calib/geometry/view_poses.h"
#include "rigproof/core/observations.h"

namespace rigproof::ml {

class FineNumbers;

class RepeatingErrors {
 public:
  /// None where lenses and board are believed, or where a drive is so long that its memory would not hold them: of
  /// that many views the images of a few would tell them all.
  RepeatingErrors() = default;
  RepeatingErrors(const Observations& observations, const PriorSigmas& priors);

  bool any() const { return size() > 0; }
  /// Independent unknowns, each of unit variance before any data.
  int size() const { return static_cast<int>(raw_by_unknowns_.cols()); }
  /// Offsets of all corners of each board (three each, by id [m]), then each camera's coefficients of its field [px].
  int raw_size() const { return static_cast<int>(raw_by_unknowns_.rows()); }
  const Eigen::MatrixXd& raw_by_unknowns() const { return raw_by_unknowns_; }
  /// raw_by_unknowns() transposed, times by_raw (raw_size() rows), by blocks, since most of the matrix is zero: the
  /// print's is full, that of a field diagonal.
  Eigen::MatrixXd by_unknowns(const Eigen::MatrixXd& by_raw) const;

  /// Where a corner's offset begins among the raw errors; -1 if the board's print is believed.
  int print(int board, int id) const {
    const int first = prints_.empty() ? -1 : prints_[static_cast<std::size_t>(board)];
    return first < 0 ? -1 : first + 3 * id;
  }
  /// Where a camera's coefficients begin; -1 if its lens is believed.
  int field(int camera) const { return fields_[static_cast<std::size_t>(camera)]; }
  /// Of a camera whose lens is not believed.
  const LensField& lens_field(int camera) const { return *lens_fields_[static_cast<std::size_t>(camera)]; }

  /// Unknowns whose size is stated by one figure: a board's print, or a camera's field.
  struct Group {
    int camera;  ///< -1: a print
    int first, size;
    double level;   ///< how many times larger than stated they are taken for
    int board = 0;  ///< of a print
    int raw = 0;    ///< where its raw errors begin
    int raw_size = 0;
  };
  const std::vector<Group>& groups() const { return groups_; }
  /// Takes a group for so many times larger.
  void enlarge(const Group& group, double factor);

 private:
  void add_print(const Board& board, int index);
  void add_field(const Camera& camera, int index);
  Group next_group(int size, int raw_size) const;

  std::vector<int> prints_, fields_;
  std::vector<std::optional<LensField>> lens_fields_;
  std::vector<Group> groups_;
  Eigen::MatrixXd raw_by_unknowns_;
};

/// What was taken out of the corners.
struct RemovedErrors {
  RepeatingErrors errors;
  /// Of each board view: displacement of its corners, two rows each, by the coefficients of its camera's field.
  std::vector<Eigen::MatrixXd> fields;
  Eigen::VectorXd value;  ///< of the errors' unknowns
  /// Of each camera: what no polynomial follows.
  struct Fine {
    struct Grid {
      int cells;
      double sigma_px;  ///< root mean square of its coefficients (FineField)
      double share;     ///< how likely it is
      double counted_px() const { return std::sqrt(share) * sigma_px; }
    };
    std::vector<Grid> grids;  ///< none where the lens is believed, no view tells, or no field at all is likelier by far
    double rms_px = 0.0;      ///< of all of them together, over the image
    double shown_px = 0.0;    ///< the same by what corners are displaced: nearly the field's, fits a grid or not
    double noise = 1.0;       ///< variance of the corners beside the field, as a multiple of what is stated
    std::shared_ptr<const FineNumbers> numbers;  ///< by which it is an unknown; null: it is none
    Eigen::VectorXd value;                       ///< of these
  };
  std::vector<Fine> fine;
  std::vector<double> absorbed;  ///< of each camera: dimensions of its corners that all these errors absorb
  /// What the errors' priors add to the cost.
  double cost() const;
  /// Of each group: how many times larger it is than stated, where neither chance explains it nor a finer field that is
  /// not larger than stated; else 1.
  std::vector<double> beyond_stated;
};
/// Nothing taken out yet.
RemovedErrors none_removed(const Observations& observations, const PriorSigmas& priors);
/// Fine fields of all lenses that are not believed, as large as they are stated to be.
void add_stated_fine_fields(const Observations& observations, RemovedErrors* removed);

/// From the images alone: every view's pose, the lenses and the board's shape are estimated with them. What is larger
/// than stated beyond what chance explains is taken for as large as it is.
/// @param known how large all of them are, of more images of the same cameras and boards; null: it is estimated
void estimate_repeating(const Observations& observations, const std::vector<ViewPose>& views, const Priors& priors,
                        const RemovedErrors* known, RemovedErrors* removed);
/// Describes what was taken out of a camera's corners by a fine field on other grids.
void describe_by(const std::vector<RemovedErrors::Fine::Grid>& grids, int camera, const Observations& observations,
                 RemovedErrors* removed);
/// Takes the estimate out of the corners of all views that have a pose.
void remove_repeating(const RemovedErrors& removed, const std::vector<ViewPose>& views, Observations* observations);

}  // namespace rigproof::ml
