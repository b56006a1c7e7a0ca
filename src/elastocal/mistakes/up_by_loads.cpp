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

constexpr double kLeftOfStated = 0.6;  // at most, with another axis up
constexpr double kLeftOfRigid = 0.75;
constexpr double kShareOfFound = 0.2;      // of what it explains is explained with the stated axis
constexpr double kLeftOfCalibrated = 0.9;  // of what causes explain with the stated axis
constexpr double kMostOfNoise = 30.0;  // of real arms 0.5 to 4 mm are left where cameras see 0.1
constexpr double kLikeNoise = 5.0;
constexpr double kOfMedian = 1.4826;  // a normal deviation's sd over its median size
constexpr int kLeastRows = 10;
constexpr int kMostRows = 60;

/// Whether gravity alone tells the loads of the joints of a robot whose root link is held.
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

/// rms distance of the markers from the robot that is calibrated from a recording, m.
double ErrorOfFit(const RecordedModel& robot, const Recording& recording,
                  const CalibrationOptions& options) {
  return MarkerError(FitOf(robot, recording, options), recording, options);
}

/// rms distance of the markers by their noise alone, m, as the distances between two on one body
/// tell, whatever the robot does; infinite without such a pair.
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
      // Both ends are noisy; the distance of a marker from its model has three coordinates.
      noises.push_back(kOfMedian * std::sqrt(3.0 / 2.0) * Median(distances));
    }
  }
  if (noises.empty()) return std::numeric_limits<double>::infinity();
  return Median(noises);
}

/// Whether springs explain much with that axis up, as good as nothing with the stated one, and
/// more than all that was found with the stated one: where noise is most of both errors.
bool OnlyItExplains(const UpByLoads& found, double rigid, double calibrated, double noise) {
  const double by_found = rigid * rigid - found.found * found.found;
  const double by_stated = rigid * rigid - found.stated * found.stated;
  return found.found < kLeftOfRigid * rigid && by_stated < kShareOfFound * by_found &&
         found.found < kLeftOfCalibrated * calibrated && found.found < kLikeNoise * noise;
}

/// Whether with that axis up nothing but the noise of the markers is left, and with the stated one,
/// with all that was found, so much more that chance does not do it, of this many coordinates: of
/// robots that hardly give way, gravity explains little, but nothing else is left.
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
  project.elasticity.extra.clear();  // causes that a wrong direction has called for
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
  } catch (const InputError&) {  // fewer equations than a robot with springs has unknowns
    return std::nullopt;
  }
  // What is wrong explains the recording: to leave less than another axis is not enough.
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
