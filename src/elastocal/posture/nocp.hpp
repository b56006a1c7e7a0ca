#pragma once

#include <functional>
#include <string>

#include "elastocal/posture/cocp.hpp"
#include "elastocal/posture/random_posture.hpp"

namespace elastocal {

/// When a set is large enough: when two additions in turn raise the index by less than `tolerance`
/// of what it was before them; these two are then not needed. (O1 is the root of the information of
/// an average posture: it rests, and is not monotone.)
struct PlateauRule {
  double tolerance = 3e-3;  ///< negative: goes on to max_postures
  int max_postures = 48;    ///< where the addition ends in any case
};

/// Index of the entry after which two additions in turn raised the index by less than `tolerance`,
/// or -1.
int FindPlateau(const std::vector<double>& indices, double tolerance);

/// A set with the way to it.
struct DesignResult {
  enum class Status {
    kPlateau,       ///< the index has come to rest
    kMaxPostures,   ///< it had not at the largest number allowed
    kNoPosture,     ///< no feasible posture was found; `blame` names the limit
    kRankDeficient  ///< the chain's postures cannot determine the parameters
  };
  PostureSet set;
  Status status = Status::kMaxPostures;
  std::string blame = {};
  std::vector<int> sizes = {};       ///< of the set after each addition
  std::vector<double> indices = {};  ///< after each addition
  SamplingCount sampling = {};       ///< of the random postures drawn
};

struct NocpOptions {
  int block = 4;  ///< N_p: postures that are added at a time
  PlateauRule plateau = {};
  CocpOptions cocp = {.patience = 2, .candidates = 30};
};

/// Algorithm 2, NOCP: adds blocks of random feasible postures, optimises each block beside the
/// others as they are, then the worst postures of all, until the index comes to rest. The set from
/// which on it rests is gone through once more, every posture.
DesignResult Nocp(PostureProblem& problem, std::uint64_t seed, const NocpOptions& options = {});

}  // namespace elastocal
