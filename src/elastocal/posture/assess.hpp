#pragma once

#include <cstdint>
#include <vector>

#include "elastocal/identifiability/observability.hpp"
#include "elastocal/posture/certificate.hpp"
#include "elastocal/posture/posture_problem.hpp"

namespace elastocal {

/// What a set of postures is worth, whoever chose it (paper section 7).
struct Assessment {
  ObservabilityIndices indices;  ///< all zero where the set does not determine all parameters
  Certificate certificate;       ///< of the feasible set; its bound is 0 where O1 is
  double efficiency = 0.0;       ///< O1 over its upper bound
  /// By identifiable parameter (column of Psi_b): the standard deviation that it would have from
  /// these postures alone with `marker_sd` of a marker coordinate; infinite without support.
  Eigen::VectorXd parameter_sd;
  Eigen::VectorXd loss;           ///< by posture: relative loss of O1 times sqrt(N_q) without it
  int adds_least = -1;            ///< posture with the smallest loss
  Eigen::VectorXd best_addition;  ///< the posture that would add most; empty where none was found
  double o1_with_addition = 0.0;
  std::vector<Violation> violations;  ///< by posture: 0 where it is feasible
};

struct AssessOptions {
  double marker_sd = 2e-4;  ///< m: what motion capture reaches
  int starts = 8;           ///< random starts of the search for the best addition
  std::uint64_t seed = 1;
  CertificateOptions certificate = {};
};

Assessment AssessPostures(PostureProblem& problem, const PostureSet& set,
                          const AssessOptions& options = {});

}  // namespace elastocal
