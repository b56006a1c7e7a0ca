// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/displacement_step.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "elastocal/math/statistics.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

constexpr int kLeastPostures = 3;    // postures on either side
constexpr double kLargestSd = 5e-4;  // m: largest standard deviation of a displacement that counts
constexpr int kAtAChange = 3;        // postures near a change of feet
// Share of the information about a displacement that must be left there.
constexpr double kLeastLeft = 0.05;

/// Contribution of one posture to the score test of a cluster's displacement, in the axes of its
/// link.
struct ShiftEffect {
  Eigen::Vector3d score = Eigen::Vector3d::Zero();        ///< A' Q r
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< A' Q A
  Eigen::Matrix3Xd cross;                                 ///< A' Q J, 3 x unknowns
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();        ///< mean over its markers, m
};

/// Contributions for one cluster, by posture in which it was seen.
using ShiftEffects = std::map<int, ShiftEffect>;

/// A linearised fit; Q eliminates the waist of each posture.
struct Linearised {
  std::vector<ShiftEffects> effects;   ///< by cluster
  std::vector<int> changes;            ///< postures from which on the robot stands on other feet
  Eigen::LLT<Eigen::MatrixXd> factor;  ///< factor of the information about all other unknowns
  Eigen::VectorXd gradient;            ///< gradient of these unknowns, J' Q r
  double squares = 0.0;                ///< sum of squared residuals
  double freedom = 0.0;                ///< rows minus unknowns, at least
};

/// Poses of the links in each posture, in the cameras' frame.
std::vector<std::vector<Transform>> LinkPoses(const FitProblem& problem, const Fit& fit) {
  Geometry geometry = ApplyErrors(problem.model, fit.delta);
  std::vector<std::vector<Transform>> poses;
  for (int i = 0; i < problem.recording.posture_count(); ++i) {
    PlaceWaist(fit.placement.T_ref_waist[i], Vector6d::Zero(), geometry);
    poses.push_back(
        CalibratedLinkTransforms(problem.model, geometry, problem.recording.q.row(i).transpose()));
  }
  return poses;
}

/// Rows minus unknowns. In a motion each moment has its own pose of the waist, but its rows count
/// as a part of a posture; the pose then counts as the same part.
double Freedom(const BodyResiduals& body, const Selection& selection, int postures) {
  std::vector<double> rows(postures, 0.0);
  std::vector<double> told(postures, 0.0);
  const int bodies = body.body_count();
  double freedom = 0.0;
  for (int b = 0; b < static_cast<int>(body.residual_blocks.size()); ++b) {
    const auto& block = body.residual_blocks[b];
    if (!block.active) continue;
    const int tie = b - bodies;
    if (tie >= static_cast<int>(body.tied_postures().size())) {
      freedom += block.size;
      continue;
    }
    const int posture = tie < 0 ? selection.bodies[b].posture : body.tied_postures()[tie];
    rows[posture] += block.size;
    told[posture] += body.Counts(b).sum();
  }
  for (int size : body.parameter_blocks) freedom -= size;
  for (int block : body.nuisance_blocks) freedom += body.parameter_blocks[block];
  for (int i = 0; i < postures; ++i) {
    if (rows[i] > 0.0) freedom += told[i] - 6.0 * told[i] / rows[i];
  }
  return freedom;
}

std::vector<int> ChangesOfFeet(const Recording& recording) {
  std::vector<int> changes;
  if (recording.trials.empty()) return changes;
  const auto support = [&](int i) -> const std::vector<int>& {
    return recording.trials[recording.trial[i]].support;
  };
  for (int i = 1; i < recording.posture_count(); ++i) {
    if (support(i) != support(i - 1)) changes.push_back(i);
  }
  return changes;
}

Linearised Linearise(const FitProblem& problem, const Selection& selection,
                     const std::vector<int>& free, const Fit& fit,
                     const std::vector<LabelCluster>& clusters) {
  FitResiduals residuals(problem, selection, free, fit);
  residuals.body.Evaluate(residuals.body.Start(), true);
  const NormalEquations equations(residuals.body);
  const std::vector<std::vector<Transform>> poses = LinkPoses(problem, fit);
  Linearised linear;
  linear.effects.resize(clusters.size());
  linear.factor.compute(equations.information());
  linear.gradient = equations.gradient();
  linear.changes = ChangesOfFeet(problem.recording);
  linear.squares = 2.0 * CostOf(residuals.body);
  linear.freedom = Freedom(residuals.body, selection, problem.recording.posture_count());
  for (int b = 0; b < residuals.body.body_count(); ++b) {
    const BodyObservation& body = selection.bodies[b];
    if (!body.used) continue;
    const Eigen::VectorXd raw =
        body.basis * residuals.body.Residual(b).cwiseProduct(residuals.body.Sds(b));
    for (std::size_t c = 0; c < clusters.size(); ++c) {
      Eigen::MatrixXd displacement = Eigen::MatrixXd::Zero(raw.size(), 3);
      Eigen::Vector3d shift = Eigen::Vector3d::Zero();
      int markers = 0;
      for (std::size_t n = 0; n < body.markers.size(); ++n) {
        const int m = body.markers[n];
        const std::vector<int>& of = clusters[c].markers;
        if (std::find(of.begin(), of.end(), m) == of.end()) continue;
        const Eigen::Matrix3d R = poses[body.posture][problem.model.markers[m].link].linear();
        const auto row = 3 * static_cast<Eigen::Index>(n);
        displacement.middleRows<3>(row) = R;
        shift += R.transpose() * raw.segment<3>(row);
        ++markers;
      }
      if (markers == 0) continue;
      const NormalEquations::Score score =
          equations.Project(b, residuals.body.Whiten(b, displacement));
      linear.effects[c][body.posture] = {score.residual, score.information, score.cross,
                                         shift / markers};
    }
  }
  return linear;
}

/// Information about a step, if only the cluster's position on its link is unknown beside it.
Eigen::Matrix3d BesideItsMean(const Eigen::Matrix3d& after, const Eigen::Matrix3d& all) {
  return after - after * all.ldlt().solve(after);
}

/// The displacement in the directions in which it is known, zero in the others. `least` is the
/// information that it has to exceed.
Eigen::Vector3d KnownDisplacement(const Eigen::Matrix3d& information, const Eigen::Matrix3d& least,
                                  const Eigen::Vector3d& score) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> directions(information);
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const double known = directions.eigenvalues()[i];  // sd^-2
    const Eigen::Vector3d along = directions.eigenvectors().col(i);
    if (!(known > 1.0 / (kLargestSd * kLargestSd)) || !(known > along.dot(least * along))) continue;
    displacement += along.dot(score) / known * along;
  }
  return displacement;
}

/// Whether the robot changes its feet between two postures, or within kAtAChange postures of them.
bool IsAtAChange(const std::vector<int>& changes, int last_before, int first_after) {
  return std::any_of(changes.begin(), changes.end(), [&](int change) {
    return change > last_before - kAtAChange && change < first_after + kAtAChange;
  });
}

/// The best step of one cluster. Counts the steps tried.
DisplacementStep BestStep(const Linearised& linear, int cluster, const Eigen::VectorXd& explained,
                          int& tried) {
  const ShiftEffects& effects = linear.effects[cluster];
  DisplacementStep best;
  best.cluster = cluster;
  ShiftEffect after;
  after.cross.setZero(3, explained.size());
  Eigen::Matrix3d all = Eigen::Matrix3d::Zero();
  for (const auto& [posture, effect] : effects) all += effect.information;
  const int count = static_cast<int>(effects.size());
  int seen = 0;
  for (auto at = effects.rbegin(); at != effects.rend(); ++at) {
    after.score += at->second.score;
    after.information += at->second.information;
    after.cross += at->second.cross;
    ++seen;
    if (seen < kLeastPostures || count - seen < kLeastPostures) continue;
    ++tried;
    const Eigen::MatrixXd W = linear.factor.matrixL().solve(after.cross.transpose());
    const Eigen::Matrix3d information = after.information - W.transpose() * W;
    const Eigen::Vector3d score = after.score - W.transpose() * explained;
    const bool at_change = IsAtAChange(linear.changes, std::next(at)->first, at->first);
    const Eigen::Matrix3d least =
        (at_change ? kLeastLeft : 0.0) * BesideItsMean(after.information, all);
    const Eigen::Vector3d displacement = KnownDisplacement(information, least, score);
    const double gain = score.dot(displacement);
    if (!(gain > best.gain)) continue;
    best = {cluster, at->first, std::next(at)->first, displacement, gain, 0.0, 0.0};
  }
  return best;
}

/// Scatter of the cluster about its mean before and its mean after the step, m per axis.
double Scatter(const ShiftEffects& effects, const DisplacementStep& step) {
  Eigen::Vector3d mean[2] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  double count[2] = {0.0, 0.0};
  for (const auto& [posture, effect] : effects) {
    const int side = posture < step.posture ? 0 : 1;
    mean[side] += effect.shift;
    count[side] += 1.0;
  }
  double squares = 0.0;
  for (const auto& [posture, effect] : effects) {
    const int side = posture < step.posture ? 0 : 1;
    squares += (effect.shift - mean[side] / count[side]).squaredNorm();
  }
  return std::sqrt(squares / (3.0 * (count[0] + count[1] - 2.0)));
}

/// Significance of the three numbers of a step among all that were tried.
double Significance(const Linearised& linear, double gain, double level) {
  const double freedom = linear.freedom - 3.0;
  if (freedom < 1.0) return 0.0;
  const double rest = std::max(linear.squares - gain, 1e-12 * linear.squares);
  return gain / 3.0 / (rest / freedom) / FisherQuantile(level, 3.0, freedom);
}

}  // namespace

DisplacementStep FindLargestStep(const FitProblem& problem, const Selection& selection,
                                 const std::vector<int>& free, const Fit& fit,
                                 const std::vector<LabelCluster>& clusters, double probability) {
  const Linearised linear = Linearise(problem, selection, free, fit, clusters);
  const Eigen::VectorXd explained = linear.factor.matrixL().solve(linear.gradient);
  DisplacementStep best;
  int tried = 0;
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    const DisplacementStep step = BestStep(linear, static_cast<int>(c), explained, tried);
    if (step.gain > best.gain) best = step;
  }
  if (best.cluster < 0) return best;
  best.scatter = Scatter(linear.effects[best.cluster], best);
  best.significance = Significance(linear, best.gain, 1.0 - probability / tried);
  return best;
}

}  // namespace elastocal
