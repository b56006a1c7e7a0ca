// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/cocp.hpp"

#include <algorithm>

#include <Eigen/Cholesky>

namespace elastocal {

int FindWorst(const PostureSet& set, Criterion criterion, WorstIndex reading,
              const std::vector<int>& passed_over) {
  Eigen::VectorXd without = IndicesWithoutEach(set, criterion);
  if (reading == WorstIndex::kAsPrinted) without = -without;
  int worst = -1;
  for (int k = 0; k < set.size(); ++k) {
    if (std::find(passed_over.begin(), passed_over.end(), k) != passed_over.end()) continue;
    if (worst < 0 || without[k] > without[worst]) worst = k;
  }
  return worst;
}

namespace {

/// Puts the most informative of `count` random postures in place of posture k and optimises it.
/// Keeps it if the set gets better.
void TryAnew(PostureProblem& problem, int k, int count, FeasibleSampler& sampler,
             const PartialOptimOptions& options, PostureSet& set) {
  const Eigen::LLT<Eigen::MatrixXd> others(set.InformationWithout({k}));
  if (others.info() != Eigen::Success) return;
  Eigen::VectorXd best;
  double most = -1.0;
  for (int i = 0; i < count; ++i) {
    const auto drawn = sampler.Draw();
    if (!drawn) break;
    const double gain = LogGain(others, EvaluateRegressor(problem, *drawn));
    if (gain > most) {
      most = gain;
      best = *drawn;
    }
  }
  if (best.size() == 0) return;
  PostureSet changed = set;
  changed.Replace(problem, k, best);
  PartialOptim(problem, {k}, changed, options);
  if (changed.Index(problem.criterion) > set.Index(problem.criterion)) set = std::move(changed);
}

}  // namespace

void Cocp(PostureProblem& problem, PostureSet& set, const CocpOptions& options,
          FeasibleSampler* sampler) {
  std::vector<int> stuck;
  for (int round = 0; round < options.max_rounds && set.size() > 1; ++round) {
    const int worst = FindWorst(set, problem.criterion, options.reading, stuck);
    if (worst < 0) return;
    const double before = set.Index(problem.criterion);
    const auto improved = [&] {
      return set.Index(problem.criterion) > before * (1.0 + options.least_gain);
    };
    PartialOptim(problem, {worst}, set, options.partial);
    if (!improved() && sampler != nullptr && options.candidates > 0) {
      TryAnew(problem, worst, options.candidates, *sampler, options.partial, set);
    }
    if (improved()) {
      stuck.clear();
      continue;
    }
    stuck.push_back(worst);
    if (static_cast<int>(stuck.size()) >= options.patience) return;
  }
}

}  // namespace elastocal
