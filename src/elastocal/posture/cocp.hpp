#pragma once

#include "elastocal/posture/partial_optim.hpp"
#include "elastocal/posture/random_posture.hpp"

namespace elastocal {

/// Which posture Algorithm 1 improves next.
enum class WorstIndex {
  kLeastLoss,  ///< the one whose removal costs least: what the text means, and what works
  kAsPrinted,  ///< argmin of O1 without it: the most valuable one
};

/// Index of that posture, those in `passed_over` aside; -1 where none is left.
int FindWorst(const PostureSet& set, Criterion criterion, WorstIndex reading,
              const std::vector<int>& passed_over = {});

struct CocpOptions {
  WorstIndex reading = WorstIndex::kLeastLoss;
  int max_rounds = 200;
  /// Ends when so many postures in turn, each the worst of those left, could not be improved. One
  /// is Algorithm 1 as printed: it stops where the worst posture is the same one twice.
  int patience = 1;
  double least_gain = 1e-5;  ///< of the index, relative: less is no improvement
  /// Before a posture counts as not to be improved, so many random feasible ones are looked at, and
  /// the best of them is optimised in its place: a way out of local maxima. 0: as printed.
  int candidates = 0;
  PartialOptimOptions partial = {};
};

/// Algorithm 1, COCP: improves the worst posture of a set, again and again.
/// `sampler` is needed where the options ask for candidates.
void Cocp(PostureProblem& problem, PostureSet& set, const CocpOptions& options = {},
          FeasibleSampler* sampler = nullptr);

}  // namespace elastocal
