#include "elastocal/validation/model_comparison.hpp"

#include <numeric>
#include <utility>
#include <vector>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

/// The fold of each posture: a random permutation is cut into equal parts.
std::vector<int> DealFolds(int postures, int folds, std::uint64_t seed) {
  std::vector<int> order(postures);
  std::iota(order.begin(), order.end(), 0);
  Random random(seed);
  for (int i = postures - 1; i > 0; --i) std::swap(order[i], order[random.Index(i + 1)]);
  std::vector<int> fold(postures);
  for (int i = 0; i < postures; ++i) fold[order[i]] = i % folds;
  return fold;
}

CalibrationResult CalibrateFold(const ErrorModel& model, const Recording& recording,
                                const BaseParameters& base, ModelKind kind,
                                const CalibrationOptions& options, const Selection& selection,
                                int fold, int folds) {
  try {
    return Calibrate(model, recording, base, kind, options, &selection);
  } catch (const InputError& error) {
    throw InputError("cross-validation, without fold " + std::to_string(fold) + " of " +
                     std::to_string(folds) + ": " + error.what());
  }
}

}  // namespace

ModelComparison CompareModels(CalibrationResult largest, const ErrorModel& model,
                              const Recording& recording, const BaseParameters& base,
                              const CalibrationOptions& options, const Progress& progress) {
  ModelComparison comparison;
  comparison.kinds = ModelKinds(model);
  const auto total = static_cast<int>(comparison.kinds.size());
  comparison.results[static_cast<int>(comparison.largest_kind())] = std::move(largest);
  const Selection used{comparison.largest().used, comparison.largest().tied};
  int done = 0;
  for (ModelKind kind : comparison.kinds) {
    const auto k = static_cast<int>(kind);
    CalibrationResult& result = comparison.results[k];
    if (kind != comparison.largest_kind()) {
      result = Calibrate(model, recording, base, kind, options, &used);
    }
    if (progress) progress(++done, total);
    comparison.predictions[k] = Predict(result.model, result.delta, recording, options);
    const Eigen::MatrixXd& distances = comparison.predictions[k].distances;
    comparison.metrics[k] = ComputeMetrics(distances, used.markers);
    comparison.metrics_all[k] = ComputeMetrics(distances, SeenMask(recording));
  }
  return comparison;
}

ModelComparison CompareModels(const ErrorModel& model, const Recording& recording,
                              const BaseParameters& base, const CalibrationOptions& options) {
  return CompareModels(Calibrate(model, recording, base, ModelKinds(model).back(), options), model,
                       recording, base, options);
}

CrossValidation CrossValidate(const ModelComparison& comparison, const ErrorModel& model,
                              const Recording& recording, const BaseParameters& base,
                              const CalibrationOptions& options, int folds, std::uint64_t seed,
                              const Progress& progress) {
  const int postures = recording.posture_count();
  if (folds < 2 || folds > postures) {
    throw InputError("cross-validation needs 2 to " + std::to_string(postures) +
                     " folds for as many postures, not " + std::to_string(folds));
  }
  const std::vector<int> fold_of = DealFolds(postures, folds, seed);
  const int steps = folds * static_cast<int>(comparison.kinds.size());
  ObservationMask predicted = comparison.largest().used;
  ByModel<Eigen::MatrixXd> distances;
  distances.fill(Eigen::MatrixXd::Zero(postures, recording.marker_count()));
  int done = 0;
  CrossValidation validation;
  validation.folds = folds;
  for (int fold = 0; fold < folds; ++fold) {
    std::vector<int> training, held_out;
    for (int i = 0; i < postures; ++i) (fold_of[i] == fold ? held_out : training).push_back(i);
    const Recording training_data = SelectPostures(recording, training);
    const Recording held_out_data = SelectPostures(recording, held_out);
    Selection selection{comparison.largest().used(training, Eigen::all), {}};
    for (int i : training) selection.tied.push_back(comparison.largest().tied[i]);
    for (ModelKind kind : comparison.kinds) {
      const CalibrationResult result =
          CalibrateFold(model, training_data, base, kind, options, selection, fold + 1, folds);
      validation.unconverged += result.termination == Termination::kConverged ? 0 : 1;
      distances[static_cast<int>(kind)](held_out, Eigen::all) =
          Predict(result.model, result.delta, held_out_data, options, &result.placement).distances;
      if (progress) progress(++done, steps);
    }
    // A marker that is in no other fold has no estimated position, so it cannot be predicted.
    for (int m = 0; m < recording.marker_count(); ++m) {
      if (selection.markers.col(m).any()) continue;
      for (int i : held_out) {
        validation.not_predicted += predicted(i, m) ? 1 : 0;
        predicted(i, m) = false;
      }
    }
  }
  for (ModelKind kind : comparison.kinds) {
    const auto k = static_cast<int>(kind);
    validation.metrics[k] = ComputeMetrics(distances[k], predicted);
  }
  return validation;
}

}  // namespace elastocal
