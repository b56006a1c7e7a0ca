// SPDX-License-Identifier: Apache-2.0
#include "elastocal/recorded/choose_elasticity.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/recorded/find_base.hpp"
#include "elastocal/robot/moving_coordinates.hpp"
#include "elastocal/validation/model_comparison.hpp"

namespace elastocal {
namespace {

constexpr int kLeastPostures = 5;
constexpr int kMostPostures = 300;
constexpr double kLeastGain = 0.02;  // share of the mean error

/// At most kMostPostures postures, evenly chosen.
Recording Sample(const Recording& recording) {
  const int all = recording.posture_count();
  if (all <= kMostPostures) return recording;
  std::vector<int> postures;
  for (int k = 0; k < kMostPostures; ++k) {
    postures.push_back(static_cast<int>(static_cast<std::int64_t>(k) * all / kMostPostures));
  }
  return SelectPostures(recording, postures);
}

/// Root mean square of the distances of each posture's markers from their predictions, m.
Eigen::VectorXd ErrorsByPosture(const Eigen::MatrixXd& distances) {
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(distances.rows());
  for (Eigen::Index i = 0; i < distances.rows(); ++i) {
    double count = 0.0;
    for (double distance : distances.row(i)) {
      if (!std::isfinite(distance)) continue;
      squares[i] += distance * distance;
      count += 1.0;
    }
    squares[i] /= std::max(1.0, count);
  }
  return squares.cwiseSqrt();
}

}  // namespace

bool HasMasses(const RobotTree& tree) {
  return std::any_of(tree.links.begin(), tree.links.end(),
                     [](const Link& link) { return link.body > 0 && link.mass > 0.0; });
}

std::optional<ElasticityTrial> TryElasticity(const Recording& recording,
                                             std::optional<std::uint64_t> seed, int most_folds,
                                             int threads, const Project& project) {
  const Recording sample = Sample(recording);
  const ErrorModel model = SelectMarkers(MakeProjectModel(project, {}), sample.marker_names);
  const BaseParameters base = FindBaseOf(project, model, sample, seed);
  const ModelKind kind = ModelKinds(model).back();
  ElasticityTrial trial;
  try {
    const CrossValidation folds =
        CrossValidate(std::vector<ModelKind>{kind}, model, sample, base, project.calibration,
                      {.folds = FoldsFor(sample, most_folds, MovingCoordinates(model)),
                       .threads = threads,
                       .by = FootingBy::kAllOfPosture});
    trial.rmse_3d = folds.metrics[static_cast<int>(kind)].rmse_3d;
    trial.errors = ErrorsByPosture(folds.distances[static_cast<int>(kind)]);
  } catch (const InputError&) {  // the estimate will say so
    return std::nullopt;
  }
  return trial;
}

std::vector<ElasticityTrial> ChooseElasticity(const Recording& recording,
                                              std::optional<std::uint64_t> seed, int most_folds,
                                              int threads, Project& project) {
  const ElasticityChoice asked = project.elasticity;
  if (!recording.trials.empty() || asked.torsion || asked.bending || !HasMasses(project.tree) ||
      recording.posture_count() < kLeastPostures) {
    return {};
  }
  using Patterns = std::vector<std::string>;
  const Patterns all = {"*"};
  const struct {
    const char* kinds;
    Patterns torsion, bending;
  } candidates[] = {{"none", {}, {}}, {"torsion", all, {}}, {"torsion and bending", all, all}};
  std::vector<ElasticityTrial> tried;
  Eigen::VectorXd best;
  std::size_t chosen = 0;
  for (const auto& candidate : candidates) {
    project.elasticity.torsion = candidate.torsion;
    project.elasticity.bending = candidate.bending;
    std::optional<ElasticityTrial> trial =
        TryElasticity(recording, seed, most_folds, threads, project);
    if (!trial) {
      project.elasticity = asked;
      return {};
    }
    trial->kinds = candidate.kinds;
    if (best.size() == 0) best = trial->errors;
    const Eigen::VectorXd gains = best - trial->errors;
    trial->gain = gains.mean();
    trial->gain_sd = StandardErrorOfMean(gains);
    if (trial->gain > std::max(trial->gain_sd, kLeastGain * best.mean())) {
      best = trial->errors;
      chosen = tried.size();
    }
    tried.push_back(std::move(*trial));
  }
  tried[chosen].chosen = true;
  project.elasticity.torsion = candidates[chosen].torsion;
  project.elasticity.bending = candidates[chosen].bending;
  return tried;
}

}  // namespace elastocal
