// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/posture/posture_problem.hpp"

namespace elastocal {

struct PartialOptimOptions {
  int max_iterations = 60;
  double tolerance = 1e-4;  ///< of log O1, by the scaled optimality of the interior-point method
};

/// The paper's partialOptim(I, q0), section 3.4.1: an interior-point method maximises the index
/// over the postures `which` of the set, starting from where they are, under the constraints of the
/// feasible set, while all other postures are fixed. The set never becomes worse: if the method
/// finds no better postures that are feasible to kFeasible, nothing changes. Returns whether
/// anything changed.
///
/// If markers can be hidden, the optimisation uses those that are seen at the start; the result is
/// judged with those that are seen in the new postures.
bool PartialOptim(PostureProblem& problem, const std::vector<int>& which, PostureSet& set,
                  const PartialOptimOptions& options = {});

}  // namespace elastocal
