// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/loose_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <Eigen/QR>

#include "elastocal/calibration/prediction.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/transform.hpp"

namespace elastocal {
namespace {

constexpr double kLeastOff = 5e-4, kLooseOff = 2e-3;  // m
constexpr double kTimesOthers = 3.0, kFarBeyondOthers = 10.0;
constexpr double kLeftOfBody = 0.5;  // largest share of the squares that a rigid motion leaves
constexpr double kLeftOfAll = 0.25;
constexpr int kFewestPostures = 8;
constexpr std::size_t kFewestClusters = 3;
constexpr std::size_t kFewestOfMoved = 3;  // a pair of single markers may hardly ever be seen

/// Sums of squared displacements of markers, m^2: as given, and after a rigid motion.
struct Squares {
  double given = 0.0, left = 0.0;
  int markers = 0, postures = 0;

  double rms() const { return std::sqrt(given / std::max(1, markers)); }
};

class Displacements {
 public:
  Displacements(const CalibrationResult& result, const Recording& recording,
                const CalibrationOptions& options)
      : recording_(recording),
        predicted_(
            Predict(result.model, result.delta, recording, options, &result.placement).positions) {}

  /// Squares of a cluster, and what a rigid motion in each posture leaves of them.
  Squares AsBody(const std::vector<int>& markers) const {
    Squares squares;
    for (int i = 0; i < recording_.posture_count(); ++i) {
      const std::vector<int> seen = SeenOf(markers, i);
      const auto count = static_cast<Eigen::Index>(seen.size());
      if (count < 3) continue;
      Eigen::MatrixXd moved(3 * count, 6);
      Eigen::VectorXd off(3 * count);
      const Eigen::Vector3d about = At(i, seen.front());
      for (Eigen::Index m = 0; m < count; ++m) {
        moved.middleRows<3>(3 * m) << Eigen::Matrix3d::Identity(),
            -Skew(At(i, seen[Size(m)]) - about);
        off.segment<3>(3 * m) = Off(i, seen[Size(m)]);
      }
      const Eigen::VectorXd without = off - moved * moved.colPivHouseholderQr().solve(off);
      squares.given += off.squaredNorm();
      // Scaled to the number of coordinates, because the fitted motion removes six of them from
      // noise.
      squares.left += without.squaredNorm() * static_cast<double>(3 * count) /
                      static_cast<double>(3 * count - 6);
      squares.markers += static_cast<int>(count);
      ++squares.postures;
    }
    return squares;
  }

  /// Squares of each cluster's mean displacement, and what is left after subtracting the
  /// displacement that all `clusters` share in each posture. Each cluster has the same weight.
  std::vector<Squares> Together(const std::vector<const LabelCluster*>& clusters) const {
    std::vector<Squares> squares(clusters.size());
    for (int i = 0; i < recording_.posture_count(); ++i) {
      std::vector<Eigen::Vector3d> means;
      Eigen::Vector3d shared = Eigen::Vector3d::Zero();
      for (const LabelCluster* cluster : clusters) {
        const std::vector<int> seen = SeenOf(cluster->markers, i);
        if (seen.empty()) continue;
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        for (const int m : seen) mean += Off(i, m) / static_cast<double>(seen.size());
        means.push_back(mean);
        shared += mean;
      }
      if (means.size() < clusters.size()) continue;
      shared /= static_cast<double>(means.size());
      for (std::size_t c = 0; c < means.size(); ++c) {
        squares[c].given += means[c].squaredNorm();
        squares[c].left += (means[c] - shared).squaredNorm();
        ++squares[c].markers;
        ++squares[c].postures;
      }
    }
    return squares;
  }

 private:
  std::vector<int> SeenOf(const std::vector<int>& markers, int posture) const {
    std::vector<int> seen;
    for (const int m : markers) {
      if (Seen(recording_, posture, m) && At(posture, m).allFinite()) seen.push_back(m);
    }
    return seen;
  }
  Eigen::Vector3d At(int posture, int marker) const {
    return predicted_.block<1, 3>(posture, 3 * marker).transpose();
  }
  Eigen::Vector3d Off(int posture, int marker) const {
    return MarkerPosition(recording_, posture, marker) - At(posture, marker);
  }

  const Recording& recording_;
  Eigen::MatrixXd predicted_;
};

/// Whether a cluster is on the root link, which joints do not move.
bool IsOnRoot(const LabelCluster& cluster, const ErrorModel& model) {
  const Marker& marker = model.markers[Size(cluster.markers.front())];
  return model.tree.links[Size(marker.link)].body == 0;
}

}  // namespace

std::optional<LooseCluster> FindLooseCluster(const CalibrationResult& result,
                                             const Recording& recording,
                                             const std::vector<LabelCluster>& clusters,
                                             const CalibrationOptions& options) {
  if (clusters.size() < kFewestClusters || recording.posture_count() < kFewestPostures) return {};
  const Displacements displacements(result, recording, options);
  std::vector<Squares> squares;
  for (const LabelCluster& cluster : clusters)
    squares.push_back(displacements.AsBody(cluster.markers));
  const auto worse = [](const Squares& a, const Squares& b) { return a.rms() < b.rms(); };
  const auto worst = std::max_element(squares.begin(), squares.end(), worse);
  double others = 0.0;
  for (auto one = squares.begin(); one != squares.end(); ++one) {
    if (one != worst) others = std::max(others, one->rms());
  }
  if (others > 0.0 && worst->postures >= kFewestPostures && worst->rms() > kLeastOff &&
      worst->rms() > kTimesOthers * others && worst->left < kLeftOfBody * worst->given) {
    const LabelCluster& cluster = clusters[Size(worst - squares.begin())];
    return LooseCluster{cluster.name, worst->rms(), worst->left / worst->given, others};
  }
  std::vector<const LabelCluster*> moved;
  for (const LabelCluster& cluster : clusters) {
    if (cluster.markers.size() < kFewestOfMoved || IsOnRoot(cluster, result.model)) continue;
    moved.push_back(&cluster);
  }
  if (moved.size() < 2) return {};
  LooseCluster all;
  all.left = 0.0;
  double given = 0.0, count = 0.0;
  for (const Squares& one : displacements.Together(moved)) {
    if (one.postures < kFewestPostures) return {};
    all.left = std::max(all.left, one.left / one.given);
    given += one.given;
    count += one.markers;
  }
  all.off = std::sqrt(given / count);
  return all.off > kLeastOff && all.left < kLeftOfAll ? std::optional(all) : std::nullopt;
}

bool IsTooLoose(const LooseCluster& loose) {
  return loose.off > std::max(kLooseOff, kFarBeyondOthers * loose.others);
}

std::string Describe(const LooseCluster& loose) {
  char text[256];
  if (loose.name.empty()) {
    std::snprintf(text, sizeof text,
                  "the robot as a whole is elsewhere beside its root link in each posture (%.2g mm "
                  "rms): a base that swings or gives way, markers of the root link that are loose, "
                  "or cameras that move?",
                  1e3 * loose.off);
    return text;
  }
  std::snprintf(text, sizeof text,
                ": its markers are elsewhere on their link in each posture (%.2g mm rms as one "
                "body, where those of other clusters are off by %.2g mm at most): a loose mount?",
                1e3 * loose.off, 1e3 * loose.others);
  return "cluster " + loose.name + text;
}

}  // namespace elastocal
