// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "elastocal/posture/cocp.hpp"
#include "elastocal/posture/random_posture.hpp"

namespace elastocal {

/// When a set is large enough: two additions in turn raise the index by less than `tolerance`,
/// relative to the index before them. These two additions are then dropped. (O1 is a root of the
/// information of an average posture; it reaches a plateau and need not rise with each addition.)
struct PlateauRule {
  double tolerance = 3e-3;  ///< if negative, the set grows to max_postures
  int max_postures = 48;    ///< the set grows no further in any case
};

/// Index of the entry after which two additions in turn raised the index by less than `tolerance`,
/// or -1.
int FindPlateau(const std::vector<double>& indices, double tolerance);

/// A set, and the sizes and indices on the way to it.
struct DesignResult {
  enum class Status {
    kPlateau,       ///< the index has reached its plateau
    kMaxPostures,   ///< no plateau was reached with the largest number allowed
    kNoPosture,     ///< no feasible posture was found; `blame` names the limit
    kRankDeficient  ///< the chain's postures cannot determine the parameters
  };
  PostureSet set;
  Status status = Status::kMaxPostures;
  std::string blame = {};
  std::vector<int> sizes = {};       ///< number of postures after each addition
  std::vector<double> indices = {};  ///< index after each addition
  SamplingCount sampling = {};       ///< of the random postures drawn
};

struct NocpOptions {
  int block = 4;  ///< N_p: number of postures that are added at a time
  PlateauRule plateau = {};
  CocpOptions cocp = {.patience = 2, .candidates = 30};
};

/// Algorithm 2, NOCP. It adds a block of random feasible postures, optimises the block while the
/// other postures are fixed, then improves the worst postures of all, and repeats this until the
/// index reaches its plateau. In the set where the plateau begins, every posture is then improved
/// once more.
DesignResult Nocp(PostureProblem& problem, std::uint64_t seed, const NocpOptions& options = {});

}  // namespace elastocal
