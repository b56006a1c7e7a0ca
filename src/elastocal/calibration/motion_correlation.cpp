// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/motion_correlation.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "elastocal/measurement/moments.hpp"

namespace elastocal {
namespace {

constexpr int kLeastMotionPairs = 10;
constexpr double kLeastShare = 0.05;  // of the displacement's variance that bodies share

/// Mean displacement of the markers of one body, m, by posture.
using BodyTrack = std::map<int, Eigen::Vector3d>;

/// Sums over pairs of moments at one distance.
struct LagSum {
  double products = 0.0;
  int pairs = 0;
};

LagSum SumAtLag(const std::vector<const BodyTrack*>& tracks, const std::vector<int>& motion,
                int lag) {
  LagSum sum;
  for (const BodyTrack* track : tracks) {
    for (const auto& [posture, displacement] : *track) {
      const auto later = track->find(posture + lag);
      if (later == track->end() || motion[posture + lag] != motion[posture]) continue;
      sum.products += displacement.dot(later->second) / 3.0;
      ++sum.pairs;
    }
  }
  return sum;
}

/// `shared`: variance of the displacement without the noise of single markers, m^2.
MotionCorrelation Correlate(const std::vector<const BodyTrack*>& tracks,
                            const std::vector<int>& motion, double shared) {
  MotionCorrelation found;
  for (int lag = 1;; ++lag) {
    const LagSum sum = SumAtLag(tracks, motion, lag);
    if (sum.pairs < kLeastMotionPairs) break;
    const double correlation = std::min(1.0, sum.products / sum.pairs / shared);
    if (lag == 1) found.lag_one = correlation;
    if (!(correlation > 0.0)) break;
    found.samples_each += 2.0 * correlation;
  }
  return found;
}

}  // namespace

std::vector<MotionCorrelation> FindMotionCorrelation(const FitProblem& problem,
                                                     const Selection& selection, const Noise& noise,
                                                     const BodyResiduals& residuals) {
  const std::vector<int> motion = MotionOfPostures(problem.recording);
  if (std::all_of(motion.begin(), motion.end(), [](int of) { return of < 0; })) return {};
  std::vector<std::map<int, BodyTrack>> tracks(noise.group_count());  // by group and body
  Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(noise.group_count());
  Eigen::ArrayXd by_markers = squares;
  Eigen::ArrayXd count = squares;
  for (int b = 0; b < residuals.body_count(); ++b) {
    const BodyObservation& body = selection.bodies[b];
    if (!body.used || motion[body.posture] < 0) continue;
    const int group = problem.group[body.posture];
    const auto markers = static_cast<double>(body.markers.size());
    const Eigen::Vector3d displacement =
        residuals.Residual(b).head<3>().cwiseProduct(residuals.Sds(b).head<3>()) /
        std::sqrt(markers);
    tracks[group][body.body][body.posture] = displacement;
    squares[group] += displacement.squaredNorm() / 3.0;
    by_markers[group] += noise.Variance(group, NoiseSource::kMarker) / markers;
    count[group] += 1.0;
  }
  std::vector<MotionCorrelation> found(noise.group_count());
  for (int g = 0; g < noise.group_count(); ++g) {
    const double shared = (squares[g] - by_markers[g]) / std::max(1.0, count[g]);
    if (!(shared * count[g] > kLeastShare * squares[g])) continue;
    std::vector<const BodyTrack*> of_group;
    for (const auto& [body, track] : tracks[g]) of_group.push_back(&track);
    found[g] = Correlate(of_group, motion, shared);
  }
  return found;
}

}  // namespace elastocal
