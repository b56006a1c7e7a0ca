// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/posture/partial_optim.hpp"
#include "elastocal/posture/random_posture.hpp"

namespace elastocal {

/// Which posture Algorithm 1 improves next.
enum class WorstIndex {
  kLeastLoss,  ///< the one whose removal costs least, as the text means; this works
  kAsPrinted,  ///< argmin of O1 without it, as printed: the most valuable one
};

/// Index of that posture, skipping those in `passed_over`; -1 if none is left.
int FindWorst(const PostureSet& set, Criterion criterion, WorstIndex reading,
              const std::vector<int>& passed_over = {});

struct CocpOptions {
  WorstIndex reading = WorstIndex::kLeastLoss;
  int max_rounds = 200;
  /// The search ends after this many postures in turn, each the worst of those left, could not be
  /// improved. With 1 it is Algorithm 1 as printed, which stops when the worst posture is the same
  /// one twice.
  int patience = 1;
  double least_gain = 1e-5;  ///< a smaller relative rise of the index is no improvement
  /// If a posture cannot be improved, this many random feasible postures are drawn, and the most
  /// informative of them is optimised in its place. This leads out of local maxima. 0: as printed.
  int candidates = 0;
  PartialOptimOptions partial = {};
};

/// Algorithm 1, COCP: improves the worst posture of a set, again and again. Options with candidates
/// need a `sampler`.
void Cocp(PostureProblem& problem, PostureSet& set, const CocpOptions& options = {},
          FeasibleSampler* sampler = nullptr);

}  // namespace elastocal
