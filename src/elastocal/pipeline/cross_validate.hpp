// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/validation/model_comparison.hpp"

namespace elastocal {

/// Inputs for decisions on an experiment from a part of its postures.
struct ExperimentData {
  const Project& project;        ///< as the calibration used it
  const Recording& as_recorded;  ///< before torque sensors and knocks were decided
  std::optional<std::uint64_t> seed;
  /// The project's statement on elastic joints, where the data chose them (ChooseElasticity).
  std::optional<ElasticityChoice> open_elasticity;
  bool chose_causes = false;  ///< causes beyond springs were taken because the data ask for them
};

/// Cross-validation in which each fold decides from its training postures alone. It decides anew
/// all that an estimate decides (CrossValidate), torque sensors that contradict statics, and
/// clusters that were knocked. In a table of at most kMostNested postures it also decides which
/// joints are elastic where the project leaves that open, and which causes are taken where all
/// postures took some. The time of a held-out posture tells whether a cluster is the one before or
/// after a knock. Between the last training posture before a knock and the first one after it, the
/// cluster is not predicted. `robot` and `comparison` are those of all postures.
CrossValidation CrossValidateExperiment(const ExperimentData& data, const RecordedModel& robot,
                                        const ModelComparison& comparison, const FoldOptions& folds,
                                        const Progress& progress = {});

inline constexpr int kMostNested = 300;

/// Ten folds for a posture table that is not very large; one each for few postures. Else 0.
int UsualFolds(const ErrorModel& model, const Recording& recording);

/// Choices that the folds do not make anew but take from all postures together: "elasticity" in
/// large tables, "causes" where a fold has too few postures to choose any.
std::vector<std::string> DecidedOnce(const ExperimentData& data, int folds);

}  // namespace elastocal
