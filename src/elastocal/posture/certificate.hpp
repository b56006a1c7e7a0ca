#pragma once

#include <cstdint>

#include "elastocal/posture/posture_problem.hpp"
#include "elastocal/posture/random_posture.hpp"

namespace elastocal {

/// An upper bound on O1 over all sets of feasible postures, of any number.
struct Certificate {
  double bound = 0.0;     ///< of O1
  double attained = 0.0;  ///< O1 of the best weighted set found, at most `bound`
  int support = 0;        ///< postures that have weight in it
  int rounds = 0;
};

struct CertificateOptions {
  int starts = 8;        ///< local searches for the most informative posture, each round
  int candidates = 200;  ///< random feasible postures they are chosen from
  int max_rounds = 30;
  double gap = 2e-3;  ///< relative distance of bound and attained at which the search ends
  std::uint64_t seed = 1;
};

/// The equivalence theorem of Kiefer and Wolfowitz: with M the mean information of a weighted set,
/// phi(q) = trace(Psi(q) M^-1 Psi(q)^T) and N_b columns,
///
///   O1 of any set <= O1(M) sqrt(max_q phi(q) / N_b),
///
/// because log det(M^-1 M') <= N_b log(trace(M^-1 M') / N_b). Starting from `set`, the postures
/// that maximise phi are added and all weights optimised until the bound is tight.
///
/// The maximum of phi is searched for from many starts, so this is a numerical bound: certain only
/// as far as that search misses nothing. O1 alone has it (std::invalid_argument otherwise).
Certificate CertifyBound(PostureProblem& problem, const PostureSet& set,
                         const CertificateOptions& options = {});

}  // namespace elastocal
