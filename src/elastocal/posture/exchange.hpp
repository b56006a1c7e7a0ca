// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "elastocal/posture/nocp.hpp"

namespace elastocal {

struct ExchangeOptions {
  int pool = 1000;  ///< random feasible postures to choose from
  int max_rounds = 100;
};

/// Draws `count` random feasible postures. If there are fewer, `result` gets the reason.
std::vector<Eigen::VectorXd> DrawPool(PostureProblem& problem, int count, std::uint64_t seed,
                                      DesignResult& result);

/// Exchange, a baseline for comparison: chooses `postures` postures from a pool of random feasible
/// ones (Mitchell's DETMAX). It adds the candidate that raises O1 most and drops the posture whose
/// removal costs least, until these are the same. A candidate may be chosen more than once. For O1
/// only (std::invalid_argument otherwise).
DesignResult ExchangeDesign(PostureProblem& problem, int postures, std::uint64_t seed,
                            const ExchangeOptions& options = {});

/// Random design, a baseline for comparison: random feasible postures, as drawn.
DesignResult RandomDesign(PostureProblem& problem, int postures, std::uint64_t seed);

}  // namespace elastocal
