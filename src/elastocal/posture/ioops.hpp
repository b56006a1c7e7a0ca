// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "elastocal/posture/nocp.hpp"

namespace elastocal {

struct IoopsOptions {
  int tabu_length = 4;  ///< number of postures improved last that are tabu (fewer than the set has)
  int patience = 12;    ///< the search ends after this many rounds without a better set
  int max_rounds = 200;
  WorstIndex reading = WorstIndex::kLeastLoss;
  PartialOptimOptions partial = {};
};

/// IOOPS, the iterative one-by-one pose search of Daney, Papegay and Madeline (2005), whose tabu
/// list is that of Joubair, Tahan and Bonev (2016), as in the paper's section 3.4.2. It works like
/// COCP but does not stop there: postures improved lately are tabu, and one that cannot be improved
/// where it is starts again from a random feasible posture. The result is the set with the highest
/// index of all rounds.
void Ioops(PostureProblem& problem, PostureSet& set, std::uint64_t seed,
           const IoopsOptions& options = {});

}  // namespace elastocal
