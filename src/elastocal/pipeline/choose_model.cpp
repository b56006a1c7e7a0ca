// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/choose_model.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "elastocal/math/statistics.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/screening/moved_markers.hpp"

namespace elastocal {
namespace {

/// Whether the second errors are smaller by more than twice the standard error of the difference.
bool IsPlainlyLess(const Eigen::VectorXd& before, const Eigen::VectorXd& after) {
  const Eigen::VectorXd gains = before - after;
  return gains.mean() > 2.0 * StandardErrorOfMean(gains);
}

/// Whether the project names the elastic joints and does not name all.
bool HoldsJointsRigid(const ElasticityChoice& own) {
  if (!own.torsion && !own.bending) return false;
  const std::vector<std::string> torsion = own.torsion.value_or(std::vector<std::string>());
  return std::find(torsion.begin(), torsion.end(), "*") == torsion.end();
}

/// Determines ModelChoice::misses_springs for a project whose model is chosen.
bool MissesSprings(const Measurements& measured, std::optional<std::uint64_t> seed, int folds,
                   int threads, Project project) {
  ElasticityChoice& own = project.elasticity;
  if (own.extra.empty() || !HoldsJointsRigid(own) || !measured.calibration.trials.empty() ||
      !HasMasses(project.tree)) {
    return false;
  }
  const auto tried = [&] {
    return TryElasticity(measured.calibration, seed, folds, threads, project);
  };
  const std::optional<ElasticityTrial> decided = tried();
  if (!decided) return false;
  own.torsion = {"*"};
  const std::optional<ElasticityTrial> beside = tried();
  if (beside && IsPlainlyLess(decided->errors, beside->errors)) return true;
  own.extra.clear();
  const std::optional<ElasticityTrial> instead = tried();
  return instead && IsPlainlyLess(decided->errors, instead->errors);
}

}  // namespace

Measurements WithMarkersInOnePlace(Measurements measured, const Project& project) {
  Recording& recording = measured.calibration;
  for (const Knock& moved : FindMovedMarkers(recording, SeenClusters(project, recording))) {
    const int before = moved.posture, after = recording.posture_count() - before;
    const int first = before < after ? 0 : before, count = std::min(before, after);
    for (const int m : moved.markers) {
      recording.markers.block(first, 3 * m, count, 3).setConstant(std::nan(""));
    }
  }
  return measured;
}

ModelChoice ChooseModel(const Measurements& given, std::optional<std::uint64_t> seed, int folds,
                        int threads, Project& project, AskForSprings ask) {
  const Measurements measured = WithMarkersInOnePlace(given, project);
  const ElasticityChoice open = project.elasticity;
  ModelChoice choice;
  // Section 2.2: the data decide whether the joints of a posture table are elastic.
  choice.elasticity = ChooseElasticity(measured.calibration, seed, folds, threads, project);
  // Not in the paper: causes that neither geometry nor springs explain, where the data ask for
  // them.
  choice.causes = ChooseCauses(measured, seed, project);
  if (choice.causes && ask == AskForSprings::kYes) {
    choice.misses_springs = MissesSprings(measured, seed, folds, threads, project);
  }

  const bool may_hide_springs = !choice.elasticity.empty() && !project.elasticity.extra.empty();
  if (!may_hide_springs) return choice;
  Project with_causes = project;
  with_causes.elasticity.torsion = open.torsion;
  with_causes.elasticity.bending = open.bending;
  std::vector<ElasticityTrial> again =
      ChooseElasticity(measured.calibration, seed, folds, threads, with_causes);
  const bool same = with_causes.elasticity.torsion == project.elasticity.torsion &&
                    with_causes.elasticity.bending == project.elasticity.bending;
  if (again.empty() || same) return choice;
  choice.elasticity = std::move(again);
  project = std::move(with_causes);
  choice.causes = ChooseCauses(measured, seed, project);
  return choice;
}

}  // namespace elastocal
