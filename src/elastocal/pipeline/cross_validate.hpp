// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/validation/model_comparison.hpp"

namespace elastocal {

/// What is needed to decide on an experiment anew, from a part of its postures.
struct ExperimentData {
  const Project& project;        ///< as the calibration used it
  const Recording& as_recorded;  ///< before torque sensors and knocks were decided on
  std::optional<std::uint64_t> seed;
  /// What the project says of elastic joints, where the data chose them (ChooseElasticity).
  std::optional<ElasticityChoice> open_elasticity;
  bool chose_causes = false;  ///< whether causes beyond springs were taken because the data ask
};

/// Cross-validation in which each fold decides anew, from its training postures alone: all that an
/// estimate decides (CrossValidate), and beside it torque sensors that contradict statics,
/// clusters that were knocked and, in a table of at most kMostNested postures, which joints are
/// elastic where the project leaves that open, and which causes are taken where all postures took
/// some. The time of a left-out posture says whether a
/// cluster is the one before or after a knock; between the last training posture before a knock and
/// the first one after it, the cluster is not predicted. `robot`, `comparison`: of all postures.
CrossValidation CrossValidateExperiment(const ExperimentData& data, const RecordedModel& robot,
                                        const ModelComparison& comparison, const FoldOptions& folds,
                                        const Progress& progress = {});

inline constexpr int kMostNested = 300;

/// What the folds do not decide anew but take as all postures together decided it: "elasticity" in
/// large tables, "causes" where a fold has too few postures to choose any.
std::vector<std::string> DecidedOnce(const ExperimentData& data, int folds);

}  // namespace elastocal
