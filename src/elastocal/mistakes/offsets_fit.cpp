// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/offsets_fit.hpp"

#include <cmath>
#include <numbers>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/recorded/find_base.hpp"

namespace elastocal {
namespace {

constexpr double kEighthOfATurn = std::numbers::pi / 4.0;

std::vector<TurnedZero> TurnedZerosOf(const CalibrationResult& result) {
  std::vector<TurnedZero> turned;
  for (int p = 0; p < result.model.parameter_count(); ++p) {
    const Parameter& parameter = result.model.parameters[Size(p)];
    if (parameter.kind != ParameterKind::kTheta || parameter.joint < 0) continue;
    const Joint& joint = result.model.tree.joints[Size(parameter.joint)];
    if (joint.type != JointType::kRevolute || joint.mimic) continue;
    if (std::abs(result.delta[p]) > kEighthOfATurn) {
      turned.push_back({joint.coordinate, result.delta[p]});
    }
  }
  return turned;
}

double OffProject(const CalibrationResult& result) {
  std::vector<double> squares(Size(result.model.marker_count()), 0.0);
  for (int p = 0; p < result.model.parameter_count(); ++p) {
    const Parameter& parameter = result.model.parameters[Size(p)];
    if (parameter.kind != ParameterKind::kMarker) continue;
    squares[Size(parameter.marker)] += result.delta[p] * result.delta[p];
  }
  double sum = 0.0;
  for (const double square : squares) sum += std::sqrt(square);
  return squares.empty() ? 0.0 : sum / static_cast<double>(squares.size());
}

}  // namespace

OffsetsFit FitOffsets(const Project& project, const ErrorModel& model, const Recording& recording) {
  try {
    const CalibrationResult result =
        Calibrate(model, recording, FindBaseOf(project, model, recording), ModelKind::kOffsetsOnly,
                  project.calibration);
    return {MarkerError(result, recording, project.calibration),
            std::isfinite(FitError(result, recording, project.calibration)), TurnedZerosOf(result),
            OffProject(result)};
  } catch (const InputError&) {
    return {};
  }
}

}  // namespace elastocal
