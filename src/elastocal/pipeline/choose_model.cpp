// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/choose_model.hpp"

#include <cmath>
#include <string>
#include <utility>

namespace elastocal {
namespace {

/// Whether the second errors are less by more than twice the standard error of that.
bool IsPlainlyLess(const Eigen::VectorXd& before, const Eigen::VectorXd& after) {
  const Eigen::ArrayXd gains = before - after;
  const auto count = static_cast<double>(gains.size());
  const double sd = std::sqrt((gains - gains.mean()).square().sum() / (count - 1.0) / count);
  return gains.mean() > 2.0 * sd;
}

/// See ModelChoice: of a project as it was decided.
bool MissesSprings(const Measurements& measured, std::optional<std::uint64_t> seed, int folds,
                   int threads, Project project) {
  ElasticityChoice& own = project.elasticity;
  const bool open = !own.torsion && !own.bending;
  const std::vector<std::string> none;
  if (open || own.extra.empty() || !own.torsion.value_or(none).empty() ||
      !own.bending.value_or(none).empty()) {
    return false;
  }
  const auto tried = [&] {  // rigid, then with torsion
    own.torsion.reset();
    own.bending.reset();
    return ChooseElasticity(measured.calibration, seed, folds, threads, project);
  };
  const std::vector<ElasticityTrial> beside = tried();
  if (beside.empty()) return false;
  if (IsPlainlyLess(beside[0].errors, beside[1].errors)) return true;
  own.extra.clear();
  const std::vector<ElasticityTrial> instead = tried();
  return !instead.empty() && IsPlainlyLess(beside[0].errors, instead[1].errors);
}

}  // namespace

ModelChoice ChooseModel(const Measurements& measured, std::optional<std::uint64_t> seed, int folds,
                        int threads, Project& project) {
  const ElasticityChoice open = project.elasticity;
  ModelChoice choice;
  // Section 2.2: whether the joints of a table of postures are taken as elastic, the data say.
  choice.elasticity = ChooseElasticity(measured.calibration, seed, folds, threads, project);
  // Not in the paper: what neither geometry nor springs explain, where the data ask for it.
  choice.causes = ChooseCauses(measured, seed, project);
  if (choice.causes) {
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
