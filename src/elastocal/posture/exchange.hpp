#pragma once

#include <cstdint>

#include "elastocal/posture/nocp.hpp"

namespace elastocal {

struct ExchangeOptions {
  int pool = 1000;  ///< random feasible postures to choose from
  int max_rounds = 100;
};

/// What most tools offer, as a baseline: the best `postures` of a pool of random feasible ones by
/// exchange (Mitchell's DETMAX): add the candidate that gains most, drop the posture that costs
/// least, until that is the same. Candidates may come more than once. O1 only
/// (std::invalid_argument otherwise).
DesignResult ExchangeDesign(PostureProblem& problem, int postures, std::uint64_t seed,
                            const ExchangeOptions& options = {});

/// The other baseline: random feasible postures as they come.
DesignResult RandomDesign(PostureProblem& problem, int postures, std::uint64_t seed);

}  // namespace elastocal
