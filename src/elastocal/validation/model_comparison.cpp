#include "elastocal/validation/model_comparison.hpp"

#include <numeric>
#include <utility>
#include <vector>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

/// Fold of each posture: a random permutation, cut into equal parts.
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
                                const CalibrationOptions& options, const ObservationMask& mask,
                                int fold, int folds) {
  try {
    return Calibrate(model, recording, base, kind, options, &mask);
  } catch (const InputError& error) {
    throw InputError("cross-validation, without fold " + std::to_string(fold) + " of " +
                     std::to_string(folds) + ": " + error.what());
  }
}

}  // namespace

ModelComparison CompareModels(const ErrorModel& model, const Recording& recording,
                              const BaseParameters& base, const CalibrationOptions& options) {
  ModelComparison comparison;
  comparison.results[2] = Calibrate(model, recording, base, ModelKind::kGeometric, options);
  const ObservationMask& used = comparison.results[2].used;
  for (int k = 0; k < 2; ++k) {
    comparison.results[k] = Calibrate(model, recording, base, kModelKinds[k], options, &used);
  }
  for (int k = 0; k < 3; ++k) {
    const CalibrationResult& result = comparison.results[k];
    const Eigen::MatrixXd distances = ResidualNorms(result.model, recording, result.delta);
    comparison.metrics[k] = ComputeMetrics(distances, used);
    comparison.metrics_all[k] = ComputeMetrics(distances, SeenMask(recording));
  }
  return comparison;
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
  ObservationMask predicted = comparison.geometric().used;
  std::array<Eigen::MatrixXd, 3> distances;
  distances.fill(Eigen::MatrixXd::Zero(postures, recording.marker_count()));
  CrossValidation validation;
  validation.folds = folds;
  for (int fold = 0; fold < folds; ++fold) {
    std::vector<int> training, held_out;
    for (int i = 0; i < postures; ++i) (fold_of[i] == fold ? held_out : training).push_back(i);
    const Recording training_data = SelectPostures(recording, training);
    const Recording held_out_data = SelectPostures(recording, held_out);
    const ObservationMask training_mask = comparison.geometric().used(training, Eigen::all);
    for (int k = 0; k < 3; ++k) {
      const CalibrationResult result = CalibrateFold(model, training_data, base, kModelKinds[k],
                                                     options, training_mask, fold + 1, folds);
      validation.unconverged += result.termination == Termination::kConverged ? 0 : 1;
      distances[k](held_out, Eigen::all) = ResidualNorms(result.model, held_out_data, result.delta);
      if (progress) progress(3 * fold + k + 1, 3 * folds);
    }
    // A marker that is in no other fold has no estimated position to predict it from.
    for (int m = 0; m < recording.marker_count(); ++m) {
      if (training_mask.col(m).any()) continue;
      for (int i : held_out) {
        validation.not_predicted += predicted(i, m) ? 1 : 0;
        predicted(i, m) = false;
      }
    }
  }
  for (int k = 0; k < 3; ++k) validation.metrics[k] = ComputeMetrics(distances[k], predicted);
  return validation;
}

}  // namespace elastocal
