// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "elastocal/pipeline/choose_causes.hpp"
#include "elastocal/recorded/choose_elasticity.hpp"

namespace elastocal {

/// What the data chose beside geometry, and what they said of the rest.
struct ModelChoice {
  std::vector<ElasticityTrial> elasticity;  ///< see ChooseElasticity
  std::optional<CauseReport> causes;        ///< see ChooseCauses
  /// The project holds joints rigid, all or some, and springs of all, beside the causes that were
  /// taken or in their place, would plainly lower the error of left-out postures: the causes may
  /// stand for them.
  bool misses_springs = false;
};

/// Whether `misses_springs` is found out, which takes several estimates.
enum class AskForSprings { kYes, kNo };

/// Decides on elastic joints, then on causes beyond geometry and springs, where the project leaves
/// them open, and sets both in the project. A large cause hides springs, and a spring that is
/// missing looks like further causes: where causes were found, elastic joints are decided on once
/// more with them and, if that changes, causes once more with the springs.
ModelChoice ChooseModel(const Measurements& measured, std::optional<std::uint64_t> seed, int folds,
                        int threads, Project& project, AskForSprings ask = AskForSprings::kYes);

}  // namespace elastocal
