// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/coarse_positions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "elastocal/math/statistics.hpp"
#include "elastocal/measurement/column_step.hpp"
#include "elastocal/robot/coordinates.hpp"
#include "elastocal/screening/distance_parabola.hpp"

namespace elastocal {
namespace {

constexpr double kLeastStep = 0.1 * M_PI / 180.0, kLeastSlide = 2e-4;
constexpr double kCoarseStep = 0.499 * M_PI / 180.0, kCoarseSlide = 0.999e-3;
constexpr double kLeftWithoutSteps = 0.8;
constexpr double kTimesChance = 3.0, kMostByChance = 0.8;
constexpr double kLeastOfRounding = 0.5;
constexpr double kMostOfStep = 0.6;  // share of a step by which a position may be moved
constexpr int kSweeps = 3;           // rounds over all joints
constexpr double kScatter = 0.25 * M_PI / 180.0, kScatterSlide = 1e-3;
constexpr double kLeftWithoutScatter = 0.5;
constexpr double kLoose = 0.5 * M_PI / 180.0, kLooseSlide = 2e-3, kLeftWithoutLoose = 0.4;
// Ratio of a normal deviation's standard deviation to its median size.
constexpr double kOfMedian = 1.4826;
constexpr int kSteps = 2;       // steps of Newton's method
constexpr double kShown = 0.1;  // share of the largest displacement
constexpr std::size_t kFewestShown = 5;

bool IsSliding(const RobotTree& tree, int coordinate) {
  return JointOfCoordinate(tree, coordinate).type == JointType::kPrismatic;
}

/// The curvature from which a joint is shown in a posture: its markers move by at least a tenth of
/// their largest displacement over all postures. A joint that carries nothing in sight still
/// changes the loads that deflect other links, but this does not determine its position.
double LeastCurvature(const DistanceParabola& parabola) {
  return kShown * kShown * std::max(0.0, parabola.Curvature().maxCoeff());
}

Eigen::ArrayXd ToLeast(const DistanceParabola& parabola) {
  return parabola.ToLeast(LeastCurvature(parabola));
}

/// For each posture: 1 where the joint is shown, else 0.
Eigen::ArrayXd Shown(const DistanceParabola& parabola) {
  return (parabola.Curvature() > LeastCurvature(parabola)).cast<double>();
}

/// Standard deviation by the median size, over the postures where the joint is shown; 0 if these
/// are few.
double SdOfShown(const Eigen::VectorXd& moved, const Eigen::ArrayXd& shown) {
  std::vector<double> sizes;
  for (Eigen::Index i = 0; i < moved.size(); ++i) {
    if (shown[i] > 0.0) sizes.push_back(std::abs(moved[i]));
  }
  return sizes.size() < kFewestShown ? 0.0 : kOfMedian * Median(sizes);
}

/// Subtracts what a joint is off by throughout a trial (the median over postures where it is
/// shown), which is no scatter.
Eigen::VectorXd AboutTrials(Eigen::VectorXd moved, const Eigen::ArrayXd& shown,
                            const Recording& recording) {
  for (int trial = 0; trial < static_cast<int>(recording.trials.size()); ++trial) {
    std::vector<double> there;
    for (Eigen::Index i = 0; i < moved.size(); ++i) {
      if (recording.trial[static_cast<std::size_t>(i)] == trial && shown[i] > 0.0) {
        there.push_back(moved[i]);
      }
    }
    if (there.size() < kFewestShown) continue;
    const double median = Median(there);
    for (Eigen::Index i = 0; i < moved.size(); ++i) {
      if (recording.trial[static_cast<std::size_t>(i)] == trial && shown[i] > 0.0) {
        moved[i] -= median;
      }
    }
  }
  return moved;
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
  // So many free numbers fit noise.
  const double chance = kTimesChance * joints / std::max(1, coordinates);
  if (joints == 0 || chance > kMostByChance) return {};
  Recording moved = recording;
  const Eigen::VectorXd given = SquaresByPosture(result, recording, options);
  Eigen::VectorXd at = given;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const CoarsePositions& one : coarse) {
      const double h = 0.25 * one.step;
      const DistanceParabola parabola = ParabolaOf(result, moved, one.coordinate, h, at, options);
      const Eigen::ArrayXd logged = recording.q.col(one.coordinate).array();
      const double most = kMostOfStep * one.step;
      auto q = moved.q.col(one.coordinate);
      q = (q.array() + h * ToLeast(parabola)).max(logged - most).min(logged + most).matrix().eval();
      at = SquaresByPosture(result, moved, options);
    }
  }
  if (!(at.sum() < std::min(kLeftWithoutSteps, 1.0 - chance) * given.sum())) return {};
  std::erase_if(coarse, [&](CoarsePositions& one) {
    const Eigen::VectorXd by = moved.q.col(one.coordinate) - recording.q.col(one.coordinate);
    const auto moved_in = static_cast<double>((by.array() != 0.0).count());
    one.off = std::sqrt(by.squaredNorm() / std::max(1.0, moved_in));
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
  const Eigen::VectorXd given = SquaresByPosture(result, recording, options);
  double least = std::min(kLeftWithoutScatter, 1.0 - chance) * given.sum();
  std::optional<ScatteredPositions> found;
  for (const int k : result.model.active_joints) {
    const Joint& joint = result.model.tree.joints[k];
    if (joint.mimic) continue;
    const double enough = joint.type == JointType::kPrismatic ? kScatterSlide : kScatter;
    Recording moved = recording;
    auto q = moved.q.col(joint.coordinate);
    Eigen::VectorXd at = given;
    Eigen::ArrayXd shown;
    for (int step = 0; step < kSteps; ++step) {
      const DistanceParabola parabola =
          ParabolaOf(result, moved, joint.coordinate, enough, at, options);
      if (step == 0) shown = Shown(parabola);
      q.array() += enough * shown * ToLeast(parabola);
      at = SquaresByPosture(result, moved, options);
      if (at.sum() > kLeftWithoutSteps * given.sum()) break;
    }
    if (!(at.sum() < least)) continue;
    const Eigen::VectorXd scatter =
        AboutTrials(q - recording.q.col(joint.coordinate), shown, recording);
    const double off = SdOfShown(scatter, shown);
    if (off < enough) continue;
    q = recording.q.col(joint.coordinate) + scatter;
    at = SquaresByPosture(result, moved, options);
    if (!(at.sum() < least)) continue;
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
  return JointOfCoordinate(tree, scattered.coordinate).name + text;
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
  return JointOfCoordinate(tree, coarse.coordinate).name + text;
}

}  // namespace elastocal
