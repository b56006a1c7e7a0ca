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

constexpr double kLeftByMotion = 0.5;  // of the error with the joint at rest
constexpr double kElsewhere = M_PI / 180.0, kElsewhereSlide = 2e-3;
constexpr double kMostTurned = M_PI, kMostSlid = 1.0;  // of a joint without limits
constexpr int kPlaces = 72;                            // of a joint, to begin with
constexpr double kShareOfPlaces = 0.25;                // of the distance of two of these
constexpr int kStepsToNearest = 3;
constexpr int kFits = 2;  // the first one has the markers where a joint at rest would

bool Slides(const RobotTree& tree, int coordinate) {
  return JointOfCoordinate(tree, coordinate).type == JointType::kPrismatic;
}

/// Coordinates that were not recorded and move what the model has.
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

/// Positions of a coordinate over all that its joint can do.
Eigen::VectorXd Places(const RobotTree& tree, int coordinate) {
  const Joint& joint = JointOfCoordinate(tree, coordinate);
  const double most = Slides(tree, coordinate) ? kMostSlid : kMostTurned;
  return Eigen::VectorXd::LinSpaced(kPlaces, std::max(-most, joint.limits.lower),
                                    std::min(most, joint.limits.upper));
}

/// The recording with the coordinate in each posture where it brings the markers nearest.
Recording Nearest(const CalibrationResult& result, const Recording& recording, int coordinate,
                  const CalibrationOptions& options) {
  const Eigen::VectorXd places = Places(result.model.tree, coordinate);
  Recording best = recording, tried = recording;
  const Eigen::VectorXd given = SquaresByPosture(result, best, options);
  Eigen::VectorXd least = given;
  const auto take = [&](const Recording& moved) {
    const Eigen::VectorXd squares = SquaresByPosture(result, moved, options);
    for (int i = 0; i < recording.posture_count(); ++i) {
      if (!(squares[i] < least[i])) continue;
      least[i] = squares[i];
      best.q(i, coordinate) = moved.q(i, coordinate);
    }
  };
  for (const double place : places) {
    tried.q.col(coordinate).setConstant(place);
    take(tried);
  }
  double step = kShareOfPlaces * (places[1] - places[0]);
  for (int k = 0; k < kStepsToNearest; ++k) {
    const DistanceParabola parabola = ParabolaOf(result, best, coordinate, step, least, options);
    tried.q.col(coordinate) = best.q.col(coordinate) + (step * parabola.ToLeast(0.0)).matrix();
    take(tried);
  }
  // What hardly changes tells the joint's loads, or noise.
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (!(least[i] < kLeftByMotion * given[i])) {
      best.q(i, coordinate) = recording.q(i, coordinate);
    }
  }
  return best;
}

/// A coordinate as the markers show it.
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
    const Recording moved = Nearest(fit, recording, coordinate, options);
    fit = Calibrate(robot.model, moved, robot.base, result.kind, options);
    motion.q = moved.q.col(coordinate);
    motion.left = FitError(fit, moved, options);
  }
  return motion;
}

/// Postures in which the joint is elsewhere than usual.
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
      "show it elsewhere in {3} of {4} postures, first in {5}, between {6:.4g} and {7:.4g} {2}. "
      "With it there the error of the fit falls from {8:.3g} to {9:.3g} mm. Record it, or leave "
      "these postures out",
      JointOfCoordinate(robot.model.tree, found->coordinate).name,
      recording.q(0, found->coordinate) / unit, slides ? "mm" : "deg", elsewhere.size(),
      recording.posture_count(), DescribePosture(recording, elsewhere.front()),
      found->q.minCoeff() / unit, found->q.maxCoeff() / unit, 1e3 * before, 1e3 * found->left);
}

}  // namespace elastocal
