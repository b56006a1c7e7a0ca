// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/motion_correlation.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "elastocal/measurement/moments.hpp"

namespace elastocal {
namespace {

constexpr int kLeastMotionPairs = 10;
// Smallest share of the model's errors in the variance of a row.
constexpr double kLeastShare = 0.05;
// Smallest increase of a row's variance by correlation that matters, relative.
constexpr double kLeastWidening = 0.5;
constexpr double kLeastLeftByPose = 0.1;  // smallest share of a row that the poses leave
constexpr double kChance = 3.0;           // in standard deviations of a correlation of zero
// Limits of the lags that are evaluated: so many pairs, but at least so many lags. Long tables
// would take too long.
constexpr int kMostPairs = 20'000'000, kLags = 500;

/// First posture and number of postures of each motion. They follow each other.
struct Motion {
  int first = 0, count = 0;
};

std::vector<Motion> FindMotions(const std::vector<int>& motion) {
  std::vector<Motion> found;
  for (int i = 0; i < static_cast<int>(motion.size()); ++i) {
    if (motion[i] < 0) continue;
    if (motion[i] == static_cast<int>(found.size())) found.push_back({i, 0});
    ++found[motion[i]].count;
  }
  return found;
}

/// Values of one quantity over the postures: the displacement of one body, or the residual of the
/// constraint. 0 where nothing was seen.
struct Track {
  Eigen::MatrixXd values;   // rows x postures
  Eigen::RowVectorXd seen;  // 1 or 0
};

/// The first rows of a residual block.
struct BlockRows {
  Eigen::ArrayXd residual;
  Eigen::ArrayXd counts;        // BodyResiduals::Counts
  Eigen::ArrayXd by_pose;       // ExplainedRows::by_nuisance
  Eigen::ArrayXd left_by_pose;  // LeftByPose
};

BlockRows RowsOf(const BodyResiduals& residuals, const ExplainedRows& explained, int block,
                 Eigen::Index rows) {
  const Eigen::ArrayXd counts = residuals.Counts(block);
  return {residuals.Residual(block).head(rows).array(), counts.head(rows),
          explained.by_nuisance[block].head(rows).array(),
          LeftByPose(explained, block, counts).head(rows)};
}

/// The tracks of one group.
class Tracks {
 public:
  explicit Tracks(int postures) : postures_(postures) {}

  /// `share` is the share of the model's errors in the variance of each row.
  void Add(int body, int posture, const BlockRows& rows, double share) {
    const auto [at, added] = tracks_.try_emplace(body);
    if (added) {
      at->second = {Eigen::MatrixXd::Zero(rows.residual.size(), postures_),
                    Eigen::RowVectorXd::Zero(postures_)};
    }
    // In standard deviations of the model's errors in one moment, as they would be if no pose were
    // estimated.
    at->second.values.col(posture) =
        rows.residual / ((1.0 - rows.by_pose).max(kLeastLeftByPose) * (share * rows.counts).sqrt());
    at->second.seen[posture] = 1.0;
    squares_ += rows.residual.square().sum();
    left_ += rows.left_by_pose.sum();
  }

  Autocorrelation Correlation(const std::vector<Motion>& motions) const {
    Autocorrelation found;
    // The parameters absorb a part of the errors, at every lag alike.
    const double left = left_ > 0.0 ? squares_ / left_ : 0.0;
    const LagSum together = SumAtLag(motions, 0);
    if (!(left > 0.0) || together.rows <= 0.0) return found;
    const double spread = together.products / together.rows / left;  // of one value
    int longest = 0;
    for (const Motion& motion : motions) longest = std::max(longest, motion.count);
    const int lags = std::min(longest, std::max(kLags, kMostPairs / std::max(1, postures_)));
    bool falls = true;     // not yet to zero
    double squares = 1.0;  // 1 + 2 sum rho_k^2, of values
    for (int lag = 1; lag < lags; ++lag) {
      const LagSum sum = SumAtLag(motions, lag);
      if (sum.pairs < kLeastMotionPairs) break;
      const double correlation = std::clamp(sum.products / sum.rows / left, -1.0, 1.0);
      if (lag == 1) found.lag_one = correlation;
      falls = falls && correlation > 0.0;
      if (falls) squares += 2.0 * std::pow(correlation / spread, 2);
      const double chance = spread * std::sqrt(squares / sum.rows);
      if (!falls && correlation < kChance * chance) continue;
      found.samples_each += 2.0 * correlation * (1.0 - static_cast<double>(lag) / longest);
    }
    return found;
  }

 private:
  /// Sums over all pairs of moments at one lag.
  struct LagSum {
    double products = 0.0, pairs = 0.0, rows = 0.0;
  };

  LagSum SumAtLag(const std::vector<Motion>& motions, int lag) const {
    LagSum sum;
    for (const Motion& motion : motions) {
      const int count = motion.count - lag;
      if (count <= 0) continue;
      for (const auto& [body, track] : tracks_) {
        sum.products += track.values.middleCols(motion.first, count)
                            .cwiseProduct(track.values.middleCols(motion.first + lag, count))
                            .sum();
        const double pairs = track.seen.segment(motion.first, count)
                                 .dot(track.seen.segment(motion.first + lag, count));
        sum.pairs += pairs;
        sum.rows += pairs * static_cast<double>(track.values.rows());
      }
    }
    return sum;
  }

  int postures_;
  std::map<int, Track> tracks_;  // by body
  double squares_ = 0.0;         // of residuals
  double left_ = 0.0;            // expected value of `squares_` if only poses were estimated
};

}  // namespace

std::vector<MotionCorrelation> FindMotionCorrelation(const FitProblem& problem,
                                                     const Selection& selection, const Noise& noise,
                                                     const BodyResiduals& residuals,
                                                     const ExplainedRows& explained) {
  const std::vector<int> motion = MotionOfPostures(problem.recording);
  const std::vector<Motion> motions = FindMotions(motion);
  if (motions.empty()) return {};
  const Tracks none(static_cast<int>(motion.size()));
  std::vector<Tracks> bodies(noise.group_count(), none);
  std::vector<Tracks> waist(noise.group_count(), none);
  std::vector<double> share_of(noise.group_count(), 0.0);  // the largest
  for (int b = 0; b < residuals.body_count(); ++b) {
    const BodyObservation& body = selection.bodies[b];
    if (!body.used || motion[body.posture] < 0) continue;
    const int group = problem.group[body.posture];
    const double share = body.Shares(noise, group, NoiseSource::kBodyPosition)[0];
    share_of[group] = std::max(share_of[group], share);
    if (share < kLeastShare) continue;
    bodies[group].Add(body.body, body.posture, RowsOf(residuals, explained, b, 3), share);
  }
  for (std::size_t t = 0; t < residuals.tied_postures().size(); ++t) {
    const int posture = residuals.tied_postures()[t];
    if (motion[posture] < 0 || selection.tied[posture] == 0) continue;
    const int block = residuals.TieBlock(static_cast<int>(t));
    waist[problem.group[posture]].Add(0, posture, RowsOf(residuals, explained, block, 6), 1.0);
  }
  std::vector<MotionCorrelation> found;
  for (int g = 0; g < noise.group_count(); ++g) {
    // Weighted by their correlation, the errors may become too small to show it; the value before
    // is then kept if it matters.
    const double before = noise.motion.empty() ? 1.0 : noise.motion[g].bodies.samples_each;
    const bool stays = share_of[g] < kLeastShare && share_of[g] * (before - 1.0) > kLeastWidening;
    found.push_back({.bodies = stays ? noise.motion[g].bodies : bodies[g].Correlation(motions),
                     .waist = waist[g].Correlation(motions)});
  }
  return found;
}

}  // namespace elastocal
