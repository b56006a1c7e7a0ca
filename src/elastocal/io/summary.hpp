#pragma once

#include <string>
#include <vector>

#include "elastocal/identifiability/observability.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/validation/model_comparison.hpp"

namespace elastocal {

/// All that a calibration run has to say.
struct CalibrationRun {
  Recording recording;
  BaseParameters base;
  Excitation excitation;
  ModelComparison comparison;
  CrossValidation cross_validation;  ///< folds 0: not asked for
  std::vector<std::string> warnings;
};

/// summary.json: the figures of a run, for programs to read (docs/formats.md).
std::string MakeSummaryJson(const CalibrationRun& run);

/// The marker seen in a posture as people find it again: "posture 12 (line 14), marker LHAND_1".
std::string DescribeObservation(const Recording& recording, int posture, int marker);

}  // namespace elastocal
