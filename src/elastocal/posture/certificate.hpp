// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "elastocal/posture/posture_problem.hpp"
#include "elastocal/posture/random_posture.hpp"

namespace elastocal {

/// An upper bound on O1 over all sets of any number of feasible postures.
struct Certificate {
  double bound = 0.0;         ///< upper bound on O1
  double attained = 0.0;      ///< O1 of the weighted set found, at most `bound`
  int weighted_postures = 0;  ///< number of postures in the weighted set
  int rounds = 0;
};

struct CertificateOptions {
  int starts = 8;        ///< local searches for the posture of largest phi, in each round
  int candidates = 200;  ///< random feasible postures from which the starts are chosen
  int max_rounds = 30;
  double gap = 2e-3;  ///< relative distance of `bound` and `attained` at which the search ends
  std::uint64_t seed = 1;
};

/// Certifies a set by the equivalence theorem of Kiefer and Wolfowitz. With M the mean information
/// of a weighted set, phi(q) = trace(Psi(q) M^-1 Psi(q)^T) and N_b columns,
///
///   O1 of any set <= O1(M) sqrt(max_q phi(q) / N_b),
///
/// because log det(M^-1 M') <= N_b log(trace(M^-1 M') / N_b). Starting from `set`, CertifyBound
/// adds the postures that maximise phi and optimises all weights, until the bound is tight.
///
/// The bound is a numerical one: the maximum of phi is searched from many starts, and the bound is
/// certain only if that search finds it. Only O1 has a bound (std::invalid_argument otherwise).
Certificate CertifyBound(PostureProblem& problem, const PostureSet& set,
                         const CertificateOptions& options = {});

}  // namespace elastocal
