// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/coarse_positions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "elastocal/calibration/prediction.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/measurement/column_step.hpp"

namespace elastocal {
namespace {

constexpr double kLeastStep = 0.1 * M_PI / 180.0, kLeastSlide = 2e-4;
constexpr double kCoarseStep = 0.499 * M_PI / 180.0, kCoarseSlide = 0.999e-3;
constexpr double kLeftWithoutSteps = 0.8;
constexpr double kTimesChance = 3.0, kMostByChance = 0.8;
constexpr double kLeastOfRounding = 0.5;
constexpr double kMostOfStep = 0.6;  // that a position is moved
constexpr int kSweeps = 3;           // over the joints
constexpr double kScatter = 0.25 * M_PI / 180.0, kScatterSlide = 1e-3;
constexpr double kLeftWithoutScatter = 0.5;
constexpr double kLoose = 0.5 * M_PI / 180.0, kLooseSlide = 2e-3, kLeftWithoutLoose = 0.4;
constexpr double kOfMedian = 1.4826;  // a normal deviation's sd over its median size
constexpr int kSteps = 2;             // of Newton's method

bool IsSliding(const RobotTree& tree, int coordinate) {
  return tree.joints[tree.coordinate_joint[coordinate]].type == JointType::kPrismatic;
}

/// By posture, m^2; the robot stands where the fit has it.
Eigen::VectorXd SquaresOf(const CalibrationResult& result, const Recording& recording,
                          const CalibrationOptions& options) {
  const Eigen::MatrixXd distances =
      Predict(result.model, result.delta, recording, options, &result.placement).distances;
  return distances.unaryExpr([](double d) { return std::isfinite(d) ? d * d : 0.0; })
      .rowwise()
      .sum();
}

/// Where a parabola through the squares at -1, 0 and 1 is least.
double LeastOf(double before, double at, double after) {
  const double curvature = before + after - 2.0 * at;
  return curvature > 0.0 ? 0.5 * (before - after) / curvature : 0.0;
}

}  // namespace

std::vector<CoarsePositions> FindCoarsePositions(const CalibrationResult& result,
                                                 const Recording& recording,
                                                 const CalibrationOptions& options,
                                                 const std::vector<TrialSummary>& trials) {
  const RobotTree& tree = result.model.tree;
  std::vector<CoarsePositions> coarse;
  for (const int k : result.model.active_joints) {
    const Joint& joint = tree.joints[k];
    if (joint.mimic) continue;
    double step = recording.trials.empty() ? StepOf(recording.q.col(joint.coordinate)) : 0.0;
    for (const TrialSummary& trial : trials) {
      const auto logged = trial.steps.find(joint.coordinate);
      if (logged != trial.steps.end()) step = std::max(step, logged->second);
    }
    const bool slides = joint.type == JointType::kPrismatic;
    if (step < 0.99 * (slides ? kLeastSlide : kLeastStep)) continue;
    coarse.push_back({joint.coordinate, step, 0.0});
  }
  const auto joints = static_cast<int>(coarse.size());
  const int coordinates = 3 * recording.marker_count();
  const double chance = kTimesChance * joints / std::max(1, coordinates);  // free numbers fit noise
  if (joints == 0 || chance > kMostByChance) return {};
  Recording moved = recording;
  const Eigen::VectorXd given = SquaresOf(result, recording, options);
  Eigen::VectorXd at = given;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const CoarsePositions& one : coarse) {
      const double h = 0.25 * one.step;
      Recording other = moved;
      other.q.col(one.coordinate).array() -= h;
      const Eigen::VectorXd before = SquaresOf(result, other, options);
      other.q.col(one.coordinate).array() += 2.0 * h;
      const Eigen::VectorXd after = SquaresOf(result, other, options);
      const Eigen::VectorXd was = moved.q.col(one.coordinate);
      for (int i = 0; i < recording.posture_count(); ++i) {
        const double nominal = recording.q(i, one.coordinate);
        const double least = was[i] + h * LeastOf(before[i], at[i], after[i]);
        moved.q(i, one.coordinate) =
            std::clamp(least, nominal - kMostOfStep * one.step, nominal + kMostOfStep * one.step);
      }
      at = SquaresOf(result, moved, options);
    }
  }
  if (!(at.sum() < std::min(kLeftWithoutSteps, 1.0 - chance) * given.sum())) return {};
  std::erase_if(coarse, [&](CoarsePositions& one) {
    const Eigen::VectorXd by = moved.q.col(one.coordinate) - recording.q.col(one.coordinate);
    one.off = std::sqrt(by.squaredNorm() / static_cast<double>(by.size()));
    return one.off < kLeastOfRounding * one.step / std::sqrt(12.0);
  });
  return coarse;
}

std::optional<ScatteredPositions> FindScatteredPositions(const CalibrationResult& result,
                                                         const Recording& recording,
                                                         const CalibrationOptions& options) {
  const int coordinates = 3 * recording.marker_count();
  const double chance = kTimesChance / std::max(1, coordinates);
  if (chance > kMostByChance || recording.posture_count() == 0) return std::nullopt;
  const Eigen::VectorXd given = SquaresOf(result, recording, options);
  double least = std::min(kLeftWithoutScatter, 1.0 - chance) * given.sum();
  std::optional<ScatteredPositions> found;
  for (const int k : result.model.active_joints) {
    const Joint& joint = result.model.tree.joints[k];
    if (joint.mimic) continue;
    const double enough = joint.type == JointType::kPrismatic ? kScatterSlide : kScatter;
    Recording moved = recording;
    auto q = moved.q.col(joint.coordinate);
    Eigen::VectorXd at = given;
    for (int step = 0; step < kSteps; ++step) {
      const Eigen::VectorXd was = q;
      q.array() -= enough;
      const Eigen::VectorXd before = SquaresOf(result, moved, options);
      q.array() += 2.0 * enough;
      const Eigen::VectorXd after = SquaresOf(result, moved, options);
      for (int i = 0; i < recording.posture_count(); ++i) {
        q[i] = was[i] + enough * LeastOf(before[i], at[i], after[i]);
      }
      at = SquaresOf(result, moved, options);
      if (at.sum() > kLeftWithoutSteps * given.sum()) break;
    }
    if (!(at.sum() < least)) continue;
    const double off =
        kOfMedian * Median((q - recording.q.col(joint.coordinate)).cwiseAbs().eval());
    if (off < enough) continue;
    least = at.sum();
    found = {joint.coordinate, off, at.sum() / given.sum()};
  }
  return found;
}

bool IsTooLoose(const ScatteredPositions& scattered, const RobotTree& tree) {
  const double most = IsSliding(tree, scattered.coordinate) ? kLooseSlide : kLoose;
  return scattered.off > most && scattered.left < kLeftWithoutLoose;
}

std::string Describe(const ScatteredPositions& scattered, const RobotTree& tree) {
  const bool slides = IsSliding(tree, scattered.coordinate);
  char text[256];
  std::snprintf(text, sizeof text,
                ": its positions scatter by %.2g %s (sd) about where the markers show them, which "
                "makes %.0f %% of the squared distances: a noisy or loose encoder, or play?",
                scattered.off / (slides ? 1e-3 : M_PI / 180.0), slides ? "mm" : "deg",
                100.0 * (1.0 - scattered.left));
  return tree.joints[tree.coordinate_joint[scattered.coordinate]].name + text;
}

bool IsTooCoarse(const CoarsePositions& coarse, const RobotTree& tree) {
  return coarse.step > (IsSliding(tree, coarse.coordinate) ? kCoarseSlide : kCoarseStep);
}

std::string Describe(const CoarsePositions& coarse, const RobotTree& tree) {
  const bool slides = IsSliding(tree, coarse.coordinate);
  const double unit = slides ? 1e-3 : M_PI / 180.0;
  char text[256];
  std::snprintf(text, sizeof text,
                ": its positions come in steps of %.3g %s, and the markers show it beside them "
                "(%.2g %s rms): record it with more digits, or estimate from more postures if its "
                "encoder is as coarse",
                coarse.step / unit, slides ? "mm" : "deg", coarse.off / unit,
                slides ? "mm" : "deg");
  return tree.joints[tree.coordinate_joint[coarse.coordinate]].name + text;
}

}  // namespace elastocal
