// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/check_alternatives.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "elastocal/calibration/prediction.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/stated_corrections.hpp"
#include "elastocal/screening/recording_faults.hpp"

namespace elastocal {
namespace {

constexpr double kLeastScale = 2e-4;  // cameras are hardly calibrated better
constexpr int kTurns = 4;             // rounds in which a size is found ...
constexpr int kMostTurns = 10;        // ... from far off, where a refit absorbs a part of it
constexpr double kMostSteps = 10.0;   // of a round

/// Sum of squared distances of a recording from the robot as calibrated, m^2.
double SquaresOf(const CheckedCalibration& calibration, const Recording& recording) {
  return std::pow(calibration.refit(recording).metrics_all.rmse_3d, 2);
}

/// The size with the smallest squares, by parabolas from `start`.
double LeastSquares(const std::function<double(double)>& squares, double start) {
  double size = start, step = 0.1 * std::abs(start);
  int near = 0;  // number of rounds that reached their aim
  for (int turn = 0; turn < kMostTurns && near < kTurns; ++turn) {
    const double here = squares(size), below = squares(size - step), above = squares(size + step);
    const double curvature = below + above - 2.0 * here;
    if (!(curvature > 0.0)) break;
    const double wanted = 0.5 * (below - above) / curvature;
    const double moved = std::clamp(wanted, -kMostSteps, kMostSteps);
    size += moved * step;
    if (moved != wanted) continue;
    step *= 0.3;
    ++near;
  }
  return size;
}

/// Whether the least of the squares is within `most` of zero, by a parabola about zero.
bool IsNearZero(const std::function<double(double)>& squares, double most) {
  const double below = squares(-most), above = squares(most);
  return std::abs(below - above) < std::max(0.0, 2.0 * (below + above - 2.0 * squares(0.0)));
}

/// Finds the scale of the cameras; 1 where it is too small to be told. The search begins at the
/// scale of the predicted markers, because the refit of root and markers has absorbed a part of the
/// true one.
double CameraScale(const CheckedCalibration& calibration, const Recording& recording,
                   const CalibrationOptions& options) {
  const CalibrationResult result = calibration.refit(recording).result;
  const double start =
      ScaleOfMarkers(recording, Predict(result.model, result.delta, recording, options).positions);
  const auto squares = [&](double size) {
    Recording corrected = recording;
    corrected.markers /= 1.0 + size;
    return SquaresOf(calibration, corrected);
  };
  if (std::abs(start - 1.0) < kLeastScale && IsNearZero(squares, kLeastScale)) return 1.0;
  return 1.0 + LeastSquares(squares, start - 1.0);
}

/// Finds the gain of a joint that explains most of the residuals of the robot as calibrated. The
/// search begins at its size to first order.
std::optional<RecordingFault> WrongGain(const CheckedCalibration& calibration,
                                        const Recording& recording,
                                        const CalibrationOptions& options) {
  for (RecordingFault& fault :
       FindRecordingFaults(calibration.refit(recording).result, recording, options)) {
    if (fault.kind != FaultKind::kJointGain || fault.trial >= 0) continue;
    const auto squares = [&](double size) {
      Recording corrected = recording;
      corrected.q.col(fault.coordinate) /= 1.0 + size;
      return SquaresOf(calibration, corrected);
    };
    fault.size = LeastSquares(squares, fault.size);
    return fault;
  }
  return std::nullopt;
}

bool Explains(const CheckedCalibration& calibration, const StatedCorrection& correction,
              const RobotTree& tree, Measurements measured) {
  try {
    ApplyCorrection(correction, tree, measured);
    return calibration.holds(measured);
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

double ScaleOfMarkers(const Recording& recording, const Eigen::MatrixXd& predicted) {
  const bool one_pose = !HasPoseByPosture(recording);
  double along = 0.0, squares = 0.0;
  std::vector<Eigen::Vector3d> at, off;
  const auto add = [&] {  // adds the markers that one pose places
    Eigen::Vector3d centre = Eigen::Vector3d::Zero(), mean_off = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < at.size(); ++k) {
      centre += at[k] / static_cast<double>(at.size());
      mean_off += off[k] / static_cast<double>(at.size());
    }
    for (std::size_t k = 0; k < at.size(); ++k) {
      along += (at[k] - centre).dot(off[k] - mean_off);
      squares += (at[k] - centre).squaredNorm();
    }
    at.clear();
    off.clear();
  };
  for (int i = 0; i < recording.posture_count(); ++i) {
    for (int m = 0; m < recording.marker_count(); ++m) {
      const Eigen::Vector3d position = predicted.block<1, 3>(i, 3 * m).transpose();
      if (!Seen(recording, i, m) || !position.allFinite()) continue;
      at.push_back(position);
      off.emplace_back(MarkerPosition(recording, i, m) - position);
    }
    if (!one_pose) add();
  }
  add();
  return squares > 0.0 ? 1.0 + along / squares : 1.0;
}

std::vector<std::string> FindAlternatives(const CheckedCalibration& calibration,
                                          const Recording& recording,
                                          const Measurements& as_recorded, const Project& project) {
  std::vector<std::string> found;
  StatedCorrection scale{.kind = FaultKind::kCameraScale};
  scale.size = CameraScale(calibration, recording, project.calibration);
  if (std::abs(scale.size - 1.0) > kLeastScale &&
      Explains(calibration, scale, project.tree, as_recorded)) {
    found.push_back(fmt::format(
        "the cameras' positions are {0:.5f} times the true ones (--accept scale={0:.5f} corrects "
        "it; a known length tells)",
        scale.size));
  }
  if (const auto fault = WrongGain(calibration, recording, project.calibration)) {
    const auto name = NameOfCorrection(*fault, project.tree, recording);
    const auto gain = name ? ParseStatedCorrection(*name, project.tree) : std::nullopt;
    if (gain && Explains(calibration, *gain, project.tree, as_recorded)) {
      found.push_back(fmt::format("{} (--accept {} corrects it)",
                                  DescribeFault(*fault, project.tree, recording), *name));
    }
  }
  return found;
}

}  // namespace elastocal
