// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

const char* ModelKindName(ModelKind kind) {
  switch (kind) {
    case ModelKind::kUncalibrated:
      return "uncalibrated";
    case ModelKind::kOffsetsOnly:
      return "offsets_only";
    case ModelKind::kGeometric:
      return "geometric";
    case ModelKind::kRigid:
      return "rigid";
    default:
      return "full";
  }
}

std::vector<ModelKind> ModelKinds(const ErrorModel& model) {
  std::vector<ModelKind> kinds = {ModelKind::kUncalibrated, ModelKind::kOffsetsOnly,
                                  ModelKind::kGeometric};
  const auto elastic = [](const Parameter& parameter) { return IsElastic(parameter.kind); };
  if (std::any_of(model.parameters.begin(), model.parameters.end(), elastic)) {
    kinds.insert(kinds.end(), {ModelKind::kRigid, ModelKind::kFull});
  }
  return kinds;
}

const char* StatusName(ParameterStatus status) {
  switch (status) {
    case ParameterStatus::kEstimated:
      return "estimated";
    case ParameterStatus::kUnsupported:
      return "unsupported";
    case ParameterStatus::kHeld:
      return "held";
    default:
      return "not_in_model";
  }
}

bool Significant(const CalibrationResult& result, int parameter) {
  return result.status[parameter] == ParameterStatus::kEstimated &&
         std::abs(result.delta[parameter]) > result.interval_factor * result.sd[parameter];
}

}  // namespace elastocal
