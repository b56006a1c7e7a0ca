// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "elastocal/pipeline/choose_causes.hpp"
#include "elastocal/recorded/choose_elasticity.hpp"

namespace elastocal {

/// What the data chose beside geometry, and what they said about the alternatives.
struct ModelChoice {
  std::vector<ElasticityTrial> elasticity;  ///< see ChooseElasticity
  std::optional<CauseReport> causes;        ///< see ChooseCauses
  /// The project holds some or all joints rigid, causes were taken, and springs in all joints,
  /// beside these causes or in their place, would plainly lower the error on held-out postures: the
  /// causes may stand for springs.
  bool misses_springs = false;
};

/// Whether to determine `misses_springs`, which takes several estimates.
enum class AskForSprings { kYes, kNo };

/// The measurements with each marker of a table that was glued on again (FindMovedMarkers) seen
/// only where it was for longer. Held-out errors would be those of its two places.
Measurements WithMarkersInOnePlace(Measurements measured, const Project& project);

/// Chooses elastic joints, then causes beyond geometry and springs, where the project leaves them
/// open, and sets both in the project. A large cause hides springs, and a missing spring looks like
/// further causes. A marker of a table that was glued on again counts where it was for longer.
/// Where causes were found, elastic joints are therefore chosen again with them and, if that
/// changes the choice, causes again with the springs.
ModelChoice ChooseModel(const Measurements& given, std::optional<std::uint64_t> seed, int folds,
                        int threads, Project& project, AskForSprings ask = AskForSprings::kYes);

}  // namespace elastocal
