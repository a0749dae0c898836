#include "rigproof/calib/vision/reference_cloud_plane.h"

#include <pcl/console/print.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/sample_consensus/ransac.h>
#include <pcl/sample_consensus/sac_model_plane.h>

#include <memory>

namespace rigproof::rivals {
namespace {

using Point = pcl::PointXYZ;

// What pcl::SACSegmentation does unless it is told otherwise, at the threshold of the program.
constexpr double kThreshold_m = 1e-4;
constexpr int kMaxIterations = 50;
constexpr double kConfidence = 0.99;

}  // namespace

std::optional<CloudPlane> largest_plane(const std::vector<Eigen::Vector3f>& points) {
  if (points.size() < 3) return std::nullopt;
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);  // it reports collinear samples on standard error
  const auto cloud = std::make_shared<pcl::PointCloud<Point>>();
  cloud->reserve(points.size());
  for (const Eigen::Vector3f& p : points) cloud->push_back({p.x(), p.y(), p.z()});
  const auto model = std::make_shared<pcl::SampleConsensusModelPlane<Point>>(cloud);  // seeded: always the same samples
  pcl::RandomSampleConsensus<Point> ransac(model, kThreshold_m);
  ransac.setMaxIterations(kMaxIterations);
  ransac.setProbability(kConfidence);
  if (!ransac.computeModel()) return std::nullopt;
  pcl::Indices inliers;
  Eigen::VectorXf best, refined;
  ransac.getInliers(inliers);
  ransac.getModelCoefficients(best);
  model->optimizeModelCoefficients(inliers, best, refined);
  if (refined.size() != 4 || !refined.allFinite()) return std::nullopt;
  return CloudPlane{refined.head<3>().cast<double>(), refined(3)};
}

}  // namespace rigproof::rivals
