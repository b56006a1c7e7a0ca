#pragma once

#include <cstdint>

#include "elastocal/posture/nocp.hpp"

namespace elastocal {

struct IoopsOptions {
  int tabu_length = 4;  ///< postures improved last that may not be chosen (less than the set)
  int patience = 12;    ///< rounds without a better set after which it ends
  int max_rounds = 200;
  WorstIndex reading = WorstIndex::kLeastLoss;
  PartialOptimOptions partial = {};
};

/// IOOPS (Joubair, Tahan and Bonev 2016, as the paper's section 3.4.2 has it): as COCP, but the
/// search is not allowed to stop: postures improved lately are tabu, and one that cannot be
/// improved where it is starts again from a random feasible posture. Gives the best set seen.
void Ioops(PostureProblem& problem, PostureSet& set, std::uint64_t seed,
           const IoopsOptions& options = {});

}  // namespace elastocal
