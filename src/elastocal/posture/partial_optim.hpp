#pragma once

#include <vector>

#include "elastocal/posture/posture_problem.hpp"

namespace elastocal {

struct PartialOptimOptions {
  int max_iterations = 60;
  double tolerance = 1e-4;  ///< of log O1, by the scaled optimality of the interior-point method
};

/// The paper's partialOptim(I, q0), section 3.4.1: maximises the index over the postures `which` of
/// the set, all others held, under the constraints of the feasible set, from where they are, by an
/// interior-point method. The set never becomes worse: where the method finds nothing better that
/// is feasible to kFeasible, postures stay. Gives whether anything changed.
///
/// Where markers can be hidden, the optimisation takes them as they are seen at the start; whether
/// the outcome is better is judged with them as they are seen there.
bool PartialOptim(PostureProblem& problem, const std::vector<int>& which, PostureSet& set,
                  const PartialOptimOptions& options = {});

}  // namespace elastocal
