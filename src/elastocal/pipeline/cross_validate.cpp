// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/cross_validate.hpp"

#include <utility>

#include "elastocal/pipeline/choose_causes.hpp"
#include "elastocal/pipeline/choose_model.hpp"
#include "elastocal/recorded/choose_elasticity.hpp"
#include "elastocal/robot/moving_coordinates.hpp"

namespace elastocal {
namespace {

bool ChoosesElasticity(const ExperimentData& data) {
  return data.open_elasticity.has_value() && data.as_recorded.posture_count() <= kMostNested;
}

/// Folds of the choice of elasticity within a fold. Every fold chooses anew, so that these inner
/// folds take most of the time of a table. Half as many as in the choice itself choose as well
/// (docs/accuracy.md).
constexpr int kInnerFolds = 5;

/// The project with the elastic joints that these postures choose and, where all postures took
/// some, the causes.
Project ProjectOfFold(const ExperimentData& data, const Measurements& training) {
  Project project = data.project;
  if (data.chose_causes && MayChooseCauses(training.calibration.posture_count())) {
    if (data.open_elasticity) project.elasticity = *data.open_elasticity;
    project.elasticity.extra.clear();  // chosen by all postures, those that are held out too
    ChooseModel(training, data.seed, kInnerFolds, 1, project, AskForSprings::kNo);
    return project;
  }
  if (!ChoosesElasticity(data)) return project;
  ElasticityChoice chosen = project.elasticity;
  project.elasticity = *data.open_elasticity;
  ChooseElasticity(training.calibration, data.seed, kInnerFolds, 1, project);
  chosen.torsion = project.elasticity.torsion;
  chosen.bending = project.elasticity.bending;
  project.elasticity = std::move(chosen);
  return project;
}

FoldData MakeExperimentFold(const ExperimentData& data, const std::vector<int>& training,
                            const std::vector<int>& held_out) {
  Measurements measured;
  measured.calibration = SelectPostures(data.as_recorded, training);
  const Project project = ProjectOfFold(data, measured);
  RecordedModel robot = MakeRecordedModel(project, data.seed, measured);
  FoldData fold;
  fold.held_out = SelectPostures(data.as_recorded, held_out);
  HideTorques(robot.contradictory, fold.held_out);
  SplitLeftOut(robot.knocks, robot.model, training, held_out, fold.held_out);
  fold.marker = MarkersBeforeSplit(robot.knocks, data.as_recorded.marker_count());
  fold.training = std::move(measured.calibration);
  fold.model = std::move(robot.model);
  fold.base = std::move(robot.base);
  return fold;
}

/// Mask of the used observations by the markers as recorded.
ObservationMask UsedAsRecorded(const RecordedModel& robot, const ModelComparison& comparison,
                               const Recording& as_recorded) {
  const ObservationMask& used = comparison.largest().used;
  const std::vector<int> marker = MarkersBeforeSplit(robot.knocks, as_recorded.marker_count());
  ObservationMask joined = used.leftCols(as_recorded.marker_count());
  for (Eigen::Index m = as_recorded.marker_count(); m < used.cols(); ++m) {
    joined.col(marker[static_cast<std::size_t>(m)]) =
        joined.col(marker[static_cast<std::size_t>(m)]) || used.col(m);
  }
  return joined;
}

}  // namespace

CrossValidation CrossValidateExperiment(const ExperimentData& data, const RecordedModel& robot,
                                        const ModelComparison& comparison, const FoldOptions& folds,
                                        const Progress& progress) {
  const auto make = [&](const std::vector<int>& training, const std::vector<int>& held_out) {
    return MakeExperimentFold(data, training, held_out);
  };
  const ErrorModel whole = SelectMarkers(MakeProjectModel(data.project, data.as_recorded.trials),
                                         data.as_recorded.marker_names);
  CrossValidation validation = CrossValidate(comparison.kinds, whole, data.as_recorded,
                                             data.project.calibration, folds, make, progress);
  JudgeWithout(UsedAsRecorded(robot, comparison, data.as_recorded), comparison.kinds, validation);
  return validation;
}

int UsualFolds(const ErrorModel& model, const Recording& recording) {
  if (!recording.trials.empty() || recording.posture_count() > 2000) return 0;
  const int folds = FoldsFor(recording, 10, MovingCoordinates(model));
  return folds < 2 ? 0 : folds;
}

std::vector<std::string> DecidedOnce(const ExperimentData& data, int folds) {
  const int postures = data.as_recorded.posture_count();
  const int smallest_training = postures - (postures + folds - 1) / folds;
  std::vector<std::string> decided;
  if (data.chose_causes && !MayChooseCauses(smallest_training)) decided.emplace_back("causes");
  if (data.open_elasticity && !ChoosesElasticity(data)) decided.emplace_back("elasticity");
  return decided;
}

}  // namespace elastocal
