#include "rigproof/calib/estimate/lasting.h"

#include <algorithm>

#include "rigproof/core/files.h"
#include "rigproof/core/text.h"

namespace rigproof::ml {
namespace {

LastingErrors::Owner owner_of(const Observations& observations, const NuisanceRow& row, int which) {
  LastingErrors::Owner owner;
  if (row.each == Each::kBoard)
    owner.board = which + 1;
  else
    owner.camera = observations.cameras[static_cast<std::size_t>(which)].name;
  return owner;
}

// visit(nuisance, row, camera or board) for every row of the table that lasts and is among the unknowns.
template <typename Visit>
void for_each_lasting(const Layout& layout, const Visit& visit) {
  for (std::size_t n = 0; n < kNuisances; ++n) {
    const Nuisance nuisance = static_cast<Nuisance>(n);
    const NuisanceRow& row = row_of(nuisance);
    for (int i = 0; row.lasts() && layout.has(nuisance) && i < layout.count(nuisance); ++i) visit(nuisance, row, i);
  }
}

// As many digits as mean something: files are written anew by other programs.
std::string text_of(double number) {
  constexpr int kDigits = 9;
  return " " + short_text(number, kDigits);
}

std::string text_of(const Camera& camera) {
  std::string text = std::to_string(camera.width_px) + " " + std::to_string(camera.height_px) + " " +
                     std::to_string(static_cast<int>(camera.lens));
  for (const double number : {camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px}) text += text_of(number);
  for (const double number : camera.distortion) text += text_of(number);
  return text;
}

std::string text_of(const RigCamera& camera) {
  return text_of(camera.camera) + " / " + text_of(camera.depth_optics()) +
         (camera.depth ? text_of(camera.depth->unit_m) : "");
}

std::string text_of(const Board& board) {
  return board.type + " " + std::to_string(board.squares_x) + " " + std::to_string(board.squares_y) +
         text_of(board.square_m) + text_of(board.marker_side_m()) + " " + board.dictionary +
         (board.legacy_pattern ? " legacy" : "");
}

std::string hash_of(const std::string& text) {
  constexpr std::size_t kDigits = 16;
  return sha256_hex(text).substr(0, kDigits);
}

}  // namespace

std::vector<LastingUnknown> lasting_unknowns(const Observations& observations, const Priors& priors) {
  const Layout layout = Layout::of(observations, priors);
  std::vector<LastingUnknown> unknowns;
  for_each_lasting(layout, [&](Nuisance nuisance, const NuisanceRow& row, int which) {
    for (int i = 0; i < row.size(); ++i) {
      const double sigma = priors.sigma(nuisance, which, i);
      const NuisanceRow::Part& part = row.parts[static_cast<std::size_t>(i)];
      if (sigma > 0.0)
        unknowns.push_back({owner_of(observations, row, which), part.name, layout.place(nuisance, which) + i,
                            part.units_per_si, sigma, std::min(sigma, part.drift.value_or(sigma))});
    }
  });
  return unknowns;
}

Eigen::VectorXd lasting_among_globals(const State& state, const Layout& layout) {
  Eigen::VectorXd values = Eigen::VectorXd::Zero(layout.globals());
  for_each_lasting(layout, [&](Nuisance nuisance, const NuisanceRow& row, int which) {
    values.segment(layout.place(nuisance, which), row.size()) = state.nuisances.of(nuisance, which);
  });
  return values;
}

std::vector<LastingErrors::Stated> hashes_of_stated(const Observations& observations) {
  std::vector<LastingErrors::Stated> stated;
  for (const RigCamera& camera : observations.cameras) {
    LastingErrors::Stated& of_camera = stated.emplace_back();
    of_camera.of.camera = camera.name;
    of_camera.hash = hash_of(text_of(camera));
  }
  for (int b = 0; b < observations.boards(); ++b) {
    LastingErrors::Stated& of_board = stated.emplace_back();
    of_board.of.board = b + 1;
    of_board.hash = hash_of(text_of(observations.board_at(b)));
  }
  return stated;
}

}  // namespace rigproof::ml
