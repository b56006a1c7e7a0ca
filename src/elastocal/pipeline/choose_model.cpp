// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/choose_model.hpp"

#include <utility>

namespace elastocal {

ModelChoice ChooseModel(const Measurements& measured, std::optional<std::uint64_t> seed, int folds,
                        int threads, Project& project) {
  const ElasticityChoice open = project.elasticity;
  ModelChoice choice;
  // Section 2.2: whether the joints of a table of postures are taken as elastic, the data say.
  choice.elasticity = ChooseElasticity(measured.calibration, seed, folds, threads, project);
  // Not in the paper: what neither geometry nor springs explain, where the data ask for it.
  choice.causes = ChooseCauses(measured, seed, project);

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
