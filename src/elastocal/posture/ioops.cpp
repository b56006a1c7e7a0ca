// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/ioops.hpp"

#include <algorithm>
#include <deque>

namespace elastocal {
void Ioops(PostureProblem& problem, PostureSet& set, std::uint64_t seed,
           const IoopsOptions& options) {
  FeasibleSampler sampler(problem.feasible, seed);
  PostureSet best = set;
  std::deque<int> tabu;
  const auto longest =
      static_cast<std::size_t>(std::min(options.tabu_length, std::max(0, set.size() - 1)));
  int idle = 0;
  for (int round = 0; round < options.max_rounds && idle < options.patience; ++round) {
    const int worst =
        FindWorst(set, problem.criterion, options.reading, {tabu.begin(), tabu.end()});
    if (worst < 0) break;
    if (!PartialOptim(problem, {worst}, set, options.partial)) {
      if (const auto fresh = sampler.Draw()) {
        set.Replace(problem, worst, *fresh);
        PartialOptim(problem, {worst}, set, options.partial);
      }
    }
    tabu.push_back(worst);
    if (tabu.size() > longest) tabu.pop_front();
    const double gain = set.Index(problem.criterion) / best.Index(problem.criterion) - 1.0;
    idle = gain > 1e-4 ? 0 : idle + 1;
    if (gain > 0.0) best = set;
  }
  set = std::move(best);
}

}  // namespace elastocal
