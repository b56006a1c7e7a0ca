// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/nocp.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace elastocal {

int FindPlateau(const std::vector<double>& indices, double tolerance) {
  for (std::size_t i = 0; i + 2 < indices.size(); ++i) {
    const double least_gain = (1.0 + tolerance) * indices[i];
    if (indices[i] > 0.0 && indices[i + 1] < least_gain && indices[i + 2] < least_gain) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

namespace {

constexpr int kPolishing = 4;  // number of postures in turn that cannot be improved

/// Improves the worst postures of the final set, for longer than between additions.
void Polish(PostureProblem& problem, const CocpOptions& usual, FeasibleSampler& sampler,
            PostureSet& set) {
  CocpOptions options = usual;
  options.patience = std::min(kPolishing, set.size());
  Cocp(problem, set, options, &sampler);
}

}  // namespace

DesignResult Nocp(PostureProblem& problem, std::uint64_t seed, const NocpOptions& options) {
  DesignResult result{PostureSet(problem.column_count())};
  FeasibleSampler sampler(problem.feasible, seed);
  PostureSet& set = result.set;
  std::vector<PostureSet> stages;
  while (set.size() < options.plateau.max_postures) {
    std::vector<int> added;
    while (static_cast<int>(added.size()) < options.block &&
           set.size() < options.plateau.max_postures) {
      const auto posture = sampler.Draw();
      if (!posture) {
        result.status = DesignResult::Status::kNoPosture;
        result.blame = sampler.Blame();
        result.sampling = sampler.count();
        return result;
      }
      added.push_back(set.size());
      set.Add(problem, *posture);
    }
    if (set.Index(problem.criterion) > 0.0) {
      PartialOptim(problem, added, set, options.cocp.partial);
      Cocp(problem, set, options.cocp, &sampler);
    }
    result.sizes.push_back(set.size());
    result.indices.push_back(set.Index(problem.criterion));
    stages.push_back(set);
    const int plateau = FindPlateau(result.indices, options.plateau.tolerance);
    if (plateau >= 0) {
      set = stages[static_cast<std::size_t>(plateau)];
      result.status = DesignResult::Status::kPlateau;
      break;
    }
  }
  if (set.Index(problem.criterion) == 0.0) {
    result.status = DesignResult::Status::kRankDeficient;
  } else {
    Polish(problem, options.cocp, sampler, set);
  }
  result.sampling = sampler.count();
  return result;
}

}  // namespace elastocal
