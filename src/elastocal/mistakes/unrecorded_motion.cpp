// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/unrecorded_motion.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/measurement/describe_posture.hpp"
#include "elastocal/measurement/recorded_joints.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/robot/coordinates.hpp"
#include "elastocal/robot/robot_tree.hpp"
#include "elastocal/screening/distance_parabola.hpp"

namespace elastocal {
namespace {

constexpr double kLeftByMotion = 0.5;  // ratio to the error with the joint at rest
constexpr double kElsewhere = M_PI / 180.0, kElsewhereSlide = 2e-3;
constexpr double kFurthestTurn = M_PI, kFurthestSlide = 1.0;  // range of a joint without limits
constexpr int kPlaces = 72;              // number of positions that are tried first
constexpr double kShareOfPlaces = 0.25;  // share of the distance between two of these
constexpr int kStepsToNearest = 3;
// Share of the largest curvature from which the joint is shown.
constexpr double kShownCurvature = 0.01;
constexpr int kFits = 2;  // in the first one, the markers are those of a resting joint

bool Slides(const RobotTree& tree, int coordinate) {
  return JointOfCoordinate(tree, coordinate).type == JointType::kPrismatic;
}

/// Coordinates that were not recorded and move a part of the model.
std::vector<int> NotRecorded(const ErrorModel& model, const Recording& recording) {
  std::vector<int> coordinates;
  for (int c = 0; c < model.tree.coordinate_count(); ++c) {
    if (IsRecorded(recording, model.tree, c)) continue;
    const bool moves = std::ranges::any_of(model.active_joints, [&](int k) {
      return std::ranges::any_of(DrivesOf(model.tree.joints[Size(k)]),
                                 [&](const Drive& drive) { return drive.coordinate == c; });
    });
    if (moves) coordinates.push_back(c);
  }
  return coordinates;
}

/// Positions of a coordinate over the range of its joint; empty where the range is zero.
Eigen::VectorXd Places(const RobotTree& tree, int coordinate) {
  const JointLimits& limits = JointOfCoordinate(tree, coordinate).limits;
  const double most = Slides(tree, coordinate) ? kFurthestSlide : kFurthestTurn;
  const double lower = std::max(-most, limits.lower), upper = std::min(most, limits.upper);
  if (!(lower < upper)) return {};
  return Eigen::VectorXd::LinSpaced(kPlaces, lower, upper);
}

/// The recording with the coordinate moved, in each posture, to where the markers are nearest.
class NearestPositions {
 public:
  NearestPositions(const CalibrationResult& result, const Recording& recording, int coordinate,
                   const CalibrationOptions& options)
      : result_(result),
        options_(options),
        coordinate_(coordinate),
        given_(SquaresByPosture(result, recording, options)),
        least_(given_),
        best_(recording) {}

  Recording Find(const Recording& recording) {
    const Eigen::VectorXd places = Places(result_.model.tree, coordinate_);
    if (places.size() == 0) return recording;
    Recording tried = recording;
    for (const double place : places) {
      tried.q.col(coordinate_).setConstant(place);
      Take(tried);
    }
    const double step = kShareOfPlaces * (places[1] - places[0]);
    for (int k = 0; k < kStepsToNearest; ++k) {
      const DistanceParabola parabola =
          ParabolaOf(result_, best_, coordinate_, step, least_, options_);
      const double flat = kShownCurvature * std::max(0.0, parabola.Curvature().maxCoeff());
      tried.q.col(coordinate_) = (best_.q.col(coordinate_).array() + step * parabola.ToLeast(flat))
                                     .max(places[0])
                                     .min(places[kPlaces - 1]);
      Take(tried);
    }
    // Where the squares hardly change, they only show the joint's loads, or noise.
    for (int i = 0; i < recording.posture_count(); ++i) {
      if (least_[i] < kLeftByMotion * given_[i]) continue;
      best_.q(i, coordinate_) = recording.q(i, coordinate_);
    }
    return best_;
  }

 private:
  /// Takes the positions that bring the markers of their posture nearer.
  void Take(const Recording& tried) {
    const Eigen::VectorXd squares = SquaresByPosture(result_, tried, options_);
    for (int i = 0; i < tried.posture_count(); ++i) {
      if (!(squares[i] < least_[i])) continue;
      least_[i] = squares[i];
      best_.q(i, coordinate_) = tried.q(i, coordinate_);
    }
  }

  const CalibrationResult& result_;
  const CalibrationOptions& options_;
  int coordinate_;
  Eigen::VectorXd given_, least_;  // squares by posture, m^2
  Recording best_;
};

/// Positions of a coordinate by the markers.
struct ShownMotion {
  int coordinate = -1;
  Eigen::VectorXd q;  ///< by posture, rad or m
  double left = 0.0;  ///< rms distance of the markers from a robot that moves so, m
};

ShownMotion MotionOf(const RecordedModel& robot, const Recording& recording,
                     const CalibrationResult& result, int coordinate,
                     const CalibrationOptions& options) {
  ShownMotion motion{coordinate, {}, 0.0};
  CalibrationResult fit = result;
  for (int k = 0; k < kFits; ++k) {
    const Recording moved = NearestPositions(fit, recording, coordinate, options).Find(recording);
    fit = Calibrate(robot.model, moved, robot.base, result.kind, options);
    motion.q = moved.q.col(coordinate);
    motion.left = FitError(fit, moved, options);
  }
  return motion;
}

/// Postures in which the joint is not at its usual position.
std::vector<int> Elsewhere(const ShownMotion& motion, bool slides) {
  const double usual = Median(motion.q);
  std::vector<int> postures;
  for (int i = 0; i < motion.q.size(); ++i) {
    if (std::abs(motion.q[i] - usual) > (slides ? kElsewhereSlide : kElsewhere)) {
      postures.push_back(i);
    }
  }
  return postures;
}

}  // namespace

std::string FindUnrecordedMotion(const Project& project, const RecordedModel& robot,
                                 const Recording& recording, const CalibrationResult& result) {
  const CalibrationOptions& options = project.calibration;
  const double before = MarkerError(result, recording, options);
  std::optional<ShownMotion> found;
  for (const int coordinate : NotRecorded(robot.model, recording)) {
    try {
      ShownMotion motion = MotionOf(robot, recording, result, coordinate, options);
      if (!(motion.left < (found ? found->left : kLeftByMotion * before))) continue;
      found = std::move(motion);
    } catch (const InputError&) {  // rods of a linkage do not close there
      continue;
    }
  }
  if (!found) return "";
  const bool slides = Slides(robot.model.tree, found->coordinate);
  const std::vector<int> elsewhere = Elsewhere(*found, slides);
  if (elsewhere.empty()) return "";
  const double unit = slides ? 1e-3 : M_PI / 180.0;
  return fmt::format(
      "{0} is not recorded, and the project says that it stood still at {1:.4g} {2}: the markers "
      "show it between {6:.4g} and {7:.4g} {2}, in {3} of {4} postures elsewhere than usual, first "
      "in {5}. With it there the error of the fit falls from {8:.3g} to {9:.3g} mm. Record it, or "
      "leave out what was measured while it was elsewhere",
      JointOfCoordinate(robot.model.tree, found->coordinate).name,
      recording.q(0, found->coordinate) / unit, slides ? "mm" : "deg", elsewhere.size(),
      recording.posture_count(), DescribePosture(recording, elsewhere.front()),
      found->q.minCoeff() / unit, found->q.maxCoeff() / unit, 1e3 * before, 1e3 * found->left);
}

}  // namespace elastocal
