// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/up_by_loads.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/recorded/choose_elasticity.hpp"
#include "elastocal/recorded/recorded_model.hpp"

namespace elastocal {
namespace {

constexpr double kLeftOfStated = 0.6;  // largest ratio to the error with the stated axis
constexpr double kLeftOfRigid = 0.75;
constexpr double kShareOfFound = 0.2;      // largest share that is explained with the stated axis
constexpr double kLeftOfCalibrated = 0.9;  // ratio to what causes leave with the stated axis
constexpr double kMostOfNoise = 30.0;      // real arms leave 0.5 to 4 mm with cameras of 0.1 mm
constexpr double kLikeNoise = 5.0;
// Ratio of a normal deviation's standard deviation to its median size.
constexpr double kOfMedian = 1.4826;
constexpr int kLeastRows = 10;
constexpr int kMostRows = 60;

/// Whether gravity alone determines the loads of the joints, for a robot whose root link is held.
bool IsHeldByStatics(const Project& project, const Recording& recording) {
  const bool held = std::all_of(recording.trials.begin(), recording.trials.end(),
                                [](const Trial& trial) { return trial.support.empty(); });
  return held && !HasFreeRoot(recording) && recording.torques.rows() == 0 &&
         HasMasses(project.tree) && recording.posture_count() >= kLeastRows;
}

CalibrationResult FitOf(const RecordedModel& robot, const Recording& recording,
                        const CalibrationOptions& options) {
  return Calibrate(robot.model, recording, robot.base, ModelKinds(robot.model).back(), options);
}

/// Root mean square distance of the markers from the robot that is calibrated from a recording, m.
double ErrorOfFit(const RecordedModel& robot, const Recording& recording,
                  const CalibrationOptions& options) {
  return MarkerError(FitOf(robot, recording, options), recording, options);
}

/// Root mean square distance of the markers by their noise alone, m, from the distances between two
/// markers on one body, whatever the robot does. Infinite without such a pair.
double NoiseByDistances(const ErrorModel& model, const Recording& recording) {
  const auto body = [&](int m) { return model.tree.links[Size(model.markers[Size(m)].link)].body; };
  std::vector<double> noises;
  for (int a = 0; a < recording.marker_count(); ++a) {
    for (int b = a + 1; b < recording.marker_count(); ++b) {
      if (body(a) != body(b)) continue;
      std::vector<double> distances;
      for (int i = 0; i < recording.posture_count(); ++i) {
        if (!Seen(recording, i, a) || !Seen(recording, i, b)) continue;
        distances.push_back(
            (MarkerPosition(recording, i, a) - MarkerPosition(recording, i, b)).norm());
      }
      if (distances.size() < Size(kLeastRows)) continue;
      const double usual = Median(distances);
      for (double& distance : distances) distance = std::abs(distance - usual);
      // Both ends are noisy; the distance of a marker from the model has three coordinates.
      noises.push_back(kOfMedian * std::sqrt(3.0 / 2.0) * Median(distances));
    }
  }
  if (noises.empty()) return std::numeric_limits<double>::infinity();
  return Median(noises);
}

/// Whether springs explain much with the found axis up, hardly anything with the stated one, and
/// more than everything found with the stated axis. This works where noise is most of both errors.
bool OnlyItExplains(const UpByLoads& found, double rigid, double calibrated, double noise) {
  const double by_found = rigid * rigid - found.found * found.found;
  const double by_stated = rigid * rigid - found.stated * found.stated;
  return found.found < kLeftOfRigid * rigid && by_stated < kShareOfFound * by_found &&
         found.found < kLeftOfCalibrated * calibrated && found.found < kLikeNoise * noise;
}

/// Whether the found axis leaves only the noise of the markers, and the stated axis, with
/// everything that was found, more than chance allows for `coordinates` numbers. On robots that
/// hardly deflect, gravity explains little, but then nothing else is left.
bool LeavesOnlyNoise(const UpByLoads& found, double calibrated, double coordinates, double noise) {
  constexpr double kClearlyMore = 1.1, kLeastLogRatio = 20.0;
  const double ratio = std::min(found.stated, calibrated) / found.found;
  return found.found < noise && ratio > kClearlyMore &&
         coordinates * std::log(ratio) > kLeastLogRatio;
}

}  // namespace

std::optional<UpByLoads> FindUpByLoads(const Project& given, std::optional<std::uint64_t> seed,
                                       const Measurements& as_recorded, double calibrated) {
  if (!IsHeldByStatics(given, as_recorded.calibration)) return std::nullopt;
  Project project = given;
  project.elasticity.torsion = std::vector<std::string>{"*"};
  project.elasticity.extra.clear();  // causes for which a wrong direction has asked
  Measurements measured = as_recorded;
  measured.calibration = EvenlyThinned(as_recorded.calibration, kMostRows);
  const RecordedModel robot = MakeRecordedModel(project, seed, measured, KnockSearch::kNone);
  Recording& recording = measured.calibration;
  const Eigen::Vector3d stated = recording.gravity;
  UpByLoads found{.axis = {}, .stated = 0.0, .found = std::numeric_limits<double>::infinity()};
  double rigid = 0.0;
  try {
    rigid = MarkerError(
        Calibrate(robot.model, recording, robot.base, ModelKind::kGeometric, project.calibration),
        recording, project.calibration);
    found.stated = ErrorOfFit(robot, recording, project.calibration);
    for (const char* axis : {"x", "-x", "y", "-y", "z", "-z"}) {
      recording.gravity = GravityBelow(axis);
      if (recording.gravity.normalized().dot(stated.normalized()) > 0.9) continue;
      const double error = ErrorOfFit(robot, recording, project.calibration);
      if (error < found.found) {
        found.axis = axis;
        found.found = error;
      }
    }
  } catch (const InputError&) {  // fewer equations than the unknowns of a robot with springs
    return std::nullopt;
  }
  // A named fault explains the recording: leaving less with another axis is then not enough.
  const double noise = NoiseByDistances(robot.model, recording);
  const auto coordinates =
      static_cast<double>(recording.markers.size() - recording.markers.array().isNaN().count());
  const bool far_better = found.found < kLeftOfStated * found.stated;
  const bool explains = far_better ? found.found < kMostOfNoise * noise
                                   : OnlyItExplains(found, rigid, calibrated, noise) ||
                                         LeavesOnlyNoise(found, calibrated, coordinates, noise);
  if (!explains) return std::nullopt;
  return found;
}

std::string Describe(const UpByLoads& found, const Recording& recording) {
  return fmt::format(
      "gravity: with {} up, joints that give way explain the recording to {:.3g} mm, as stated "
      "only to {:.3g} mm; is {} the axis of the markers' frame that points up? ({})",
      found.axis, 1e3 * found.found, 1e3 * found.stated, found.axis,
      recording.trials.empty()
          ? "recording.up in the project; a direction [x, y, z], where no axis does"
          : "up in experiment.yaml");
}

}  // namespace elastocal
