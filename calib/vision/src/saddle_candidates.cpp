#include "saddle_candidates.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "rigproof/core/conventions.h"

namespace rigproof::detection {
namespace {

using Eigen::Vector2f;

// Pixels at the image's edge where the ring around a candidate would leave it.
constexpr int kBorder = 5;
constexpr int kRingSamples = 16;
constexpr float kRingRadius = 3.2F;
// Light minus dark below which texture and noise abound [grey levels].
constexpr float kMinContrast = 12.0F;
// Response of a saddle of that contrast blurred by 2 px, halved for edges that cross at 45 degrees: with half
// contrast c, I_xy = (2 / pi) c / sigma^2, and the response is 16 I_xy^2 in SmoothImage units.
constexpr int kMinResponse = 2500;

// -det(Hessian) * 16 of three rows, positive at saddles.
void saddle_response(const SmoothImage& image, int y, std::int32_t* response) {
  const std::int16_t *a = image.row(y - 1), *b = image.row(y), *c = image.row(y + 1);
  for (int x = 1; x < image.width - 1; ++x) {
    const int xx = b[x - 1] - 2 * b[x] + b[x + 1];
    const int yy = a[x] - 2 * b[x] + c[x];
    const int xy4 = a[x - 1] - a[x + 1] - c[x - 1] + c[x + 1];
    response[x] = xy4 * xy4 - 16 * xx * yy;
  }
}

struct Peak {
  int x, y;
  std::int32_t response;
};

bool is_largest(const std::vector<std::int32_t>& response, std::size_t width, std::size_t i) {
  const std::int32_t value = response[i];
  for (std::size_t dy = 0; dy < 5; ++dy) {
    for (std::size_t dx = 0; dx < 5; ++dx) {
      const std::size_t j = i + dy * width + dx - 2 * width - 2;
      // Of equal neighbours the first one wins.
      if (response[j] > value || (response[j] == value && j < i)) return false;
    }
  }
  return true;
}

std::vector<Peak> find_peaks(const SmoothImage& image) {
  const auto width = static_cast<std::size_t>(image.width);
  std::vector<std::int32_t> response(width * static_cast<std::size_t>(image.height), 0);
  for (int y = 1; y < image.height - 1; ++y)
    saddle_response(image, y, response.data() + static_cast<std::size_t>(y) * width);
  std::vector<Peak> peaks;
  for (int y = kBorder; y < image.height - kBorder; ++y) {
    const std::int32_t* row = response.data() + static_cast<std::size_t>(y) * width;
    for (int x = kBorder; x < image.width - kBorder; ++x) {
      if (row[x] < kMinResponse || row[x] < row[x - 1] || row[x] < row[x + 1]) continue;
      if (is_largest(response, width, static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)))
        peaks.push_back({x, y, row[x]});
    }
  }
  return peaks;
}

// The stationary point near a peak of the response, or nothing if there is none within a pixel and a half.
std::optional<Vector2f> stationary_point(const SmoothImage& image, const Peak& peak) {
  const std::int16_t *a = image.row(peak.y - 1) + peak.x, *b = image.row(peak.y) + peak.x,
                     *c = image.row(peak.y + 1) + peak.x;
  const auto real = [](int value) { return static_cast<float>(value); };
  const float xx = real(b[-1] - 2 * b[0] + b[1]), yy = real(a[0] - 2 * b[0] + c[0]);
  const float xy = 0.25F * real(a[-1] - a[1] - c[-1] + c[1]);
  const float gx = 0.5F * real(b[1] - b[-1]), gy = 0.5F * real(c[0] - a[0]);
  const float det = xx * yy - xy * xy;
  const Vector2f offset((xy * gy - yy * gx) / det, (xy * gx - xx * gy) / det);
  if (!(offset.cwiseAbs().maxCoeff() < 1.5F)) return std::nullopt;
  return Vector2f(real(peak.x), real(peak.y)) + offset;
}

const std::array<Vector2f, kRingSamples>& ring_directions() {
  static const auto directions = [] {
    std::array<Vector2f, kRingSamples> result;
    for (int i = 0; i < kRingSamples; ++i) {
      const double angle = 2.0 * kPi * i / kRingSamples;
      result[static_cast<std::size_t>(i)] = Vector2f(std::cos(angle), std::sin(angle));
    }
    return result;
  }();
  return directions;
}

// Cosine of the largest angle by which an edge may bend at the saddle, 35 degrees.
constexpr float kMaxBendCosine = 0.82F;

// Two edges must go through the point: opposite directions, and neither sector narrower than 25 degrees.
bool edges_go_through(const std::array<Vector2f, 4>& edges) {
  if (edges[0].dot(edges[2]) > -kMaxBendCosine || edges[1].dot(edges[3]) > -kMaxBendCosine) return false;
  for (std::size_t i = 0; i < 4; ++i)
    if (edges[i].dot(edges[(i + 1) % 4]) > 0.906F) return false;
  return true;
}

std::optional<SaddleCandidate> examine_ring(const SmoothImage& image, const Vector2f& centre) {
  const float reach = kRingRadius + 1.0F;
  if (!image.contains(centre.x() - reach, centre.y() - reach) ||
      !image.contains(centre.x() + reach, centre.y() + reach))
    return std::nullopt;
  std::array<float, kRingSamples> ring;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vector2f p = centre + kRingRadius * ring_directions()[i];
    ring[i] = image.sample(p.x(), p.y());
  }
  const auto [low, high] = std::minmax_element(ring.begin(), ring.end());
  const float contrast = *high - *low, middle = 0.5F * (*high + *low);
  if (contrast < kMinContrast * kSmoothScale) return std::nullopt;
  if (std::abs(image.sample(centre.x(), centre.y()) - middle) > 0.35F * contrast) return std::nullopt;
  SaddleCandidate candidate;
  std::size_t count = 0, first_rising = 4;
  std::array<Vector2f, 4> crossings;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const std::size_t next = (i + 1) % ring.size();
    const bool light = ring[i] >= middle, light_next = ring[next] >= middle;
    if (light == light_next) continue;
    if (count == 4) return std::nullopt;
    if (light_next && first_rising == 4) first_rising = count;
    const float t = (middle - ring[i]) / (ring[next] - ring[i]);
    crossings[count++] = (ring_directions()[i] + t * (ring_directions()[next] - ring_directions()[i])).normalized();
  }
  if (count != 4) return std::nullopt;
  for (std::size_t i = 0; i < 4; ++i) candidate.edges[i] = crossings[(first_rising + i) % 4];
  if (!edges_go_through(candidate.edges)) return std::nullopt;
  candidate.position = centre;
  candidate.contrast = contrast;
  return candidate;
}

}  // namespace

std::vector<SaddleCandidate> find_saddle_candidates(const SmoothImage& image, std::size_t max_count) {
  if (image.width <= 2 * kBorder || image.height <= 2 * kBorder) return {};
  std::vector<Peak> peaks = find_peaks(image);
  std::sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) {
    if (a.response != b.response) return a.response > b.response;
    return a.y != b.y ? a.y < b.y : a.x < b.x;
  });
  std::vector<SaddleCandidate> candidates;
  for (const Peak& peak : peaks) {
    if (candidates.size() == max_count) break;
    const std::optional<Vector2f> centre = stationary_point(image, peak);
    if (!centre) continue;
    if (const std::optional<SaddleCandidate> candidate = examine_ring(image, *centre)) candidates.push_back(*candidate);
  }
  return candidates;
}

}  // namespace rigproof::detection
