// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "elastocal/identifiability/observability.hpp"
#include "elastocal/posture/certificate.hpp"
#include "elastocal/posture/posture_problem.hpp"

namespace elastocal {

/// How well a given set of postures determines the parameters (paper section 7).
struct Assessment {
  ObservabilityIndices indices;  ///< all zero if the set does not determine all parameters
  Certificate certificate;       ///< for the feasible set; its bound is 0 if O1 is 0
  double efficiency = 0.0;       ///< O1 over its upper bound
  /// For each identifiable parameter (column of Psi_b), the standard deviation that it would have
  /// from these postures alone, with `marker_sd` for a marker coordinate; infinite if they do not
  /// determine it.
  Eigen::VectorXd parameter_sd;
  Eigen::VectorXd loss;  ///< for each posture, relative loss of O1 times sqrt(N_q) without it
  int adds_least = -1;   ///< posture with the smallest loss
  Eigen::VectorXd best_addition;  ///< the posture that would raise O1 most; empty if none was found
  double o1_with_addition = 0.0;
  std::vector<Violation> violations;  ///< for each posture, 0 if it is feasible
};

struct AssessOptions {
  double marker_sd = 2e-4;  ///< standard deviation of a marker coordinate, m
  int starts = 8;           ///< random starts of the search for `best_addition`
  std::uint64_t seed = 1;
  CertificateOptions certificate = {};
};

/// Assesses a set of postures, which need not be feasible.
Assessment AssessPostures(PostureProblem& problem, const PostureSet& set,
                          const AssessOptions& options = {});

}  // namespace elastocal
