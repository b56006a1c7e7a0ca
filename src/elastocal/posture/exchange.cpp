// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/exchange.hpp"

#include <cmath>
#include <stdexcept>

#include <Eigen/Cholesky>

namespace elastocal {
namespace {

/// Index of the candidate that raises log det of the information most.
int FindMostInformative(const Eigen::MatrixXd& information,
                        const std::vector<Eigen::MatrixXd>& psi) {
  const Eigen::LLT<Eigen::MatrixXd> factor(information);
  int best = 0;
  double most = -1.0;
  for (std::size_t i = 0; i < psi.size(); ++i) {
    const double log_gain = LogGain(factor, psi[i]);
    if (log_gain > most) {
      most = log_gain;
      best = static_cast<int>(i);
    }
  }
  return best;
}

}  // namespace

std::vector<Eigen::VectorXd> DrawPool(PostureProblem& problem, int count, std::uint64_t seed,
                                      DesignResult& result) {
  FeasibleSampler sampler(problem.feasible, seed);
  std::vector<Eigen::VectorXd> pool;
  while (static_cast<int>(pool.size()) < count) {
    const auto drawn = sampler.Draw();
    if (!drawn) {
      result.status = DesignResult::Status::kNoPosture;
      result.blame = sampler.Blame();
      break;
    }
    pool.push_back(*drawn);
  }
  result.sampling = sampler.count();
  return pool;
}

DesignResult ExchangeDesign(PostureProblem& problem, int postures, std::uint64_t seed,
                            const ExchangeOptions& options) {
  if (problem.criterion != Criterion::kO1) {
    throw std::invalid_argument("ExchangeDesign: only for O1");
  }
  DesignResult result{PostureSet(problem.column_count())};
  const std::vector<Eigen::VectorXd> pool = DrawPool(problem, options.pool, seed, result);
  if (static_cast<int>(pool.size()) < postures) return result;
  std::vector<Eigen::MatrixXd> psi;
  for (const Eigen::VectorXd& x : pool) psi.push_back(EvaluateRegressor(problem, x));
  PostureSet& set = result.set;
  for (int k = 0; k < postures; ++k) set.Add(problem, pool[k]);
  for (int round = 0; round < options.max_rounds && set.Index(Criterion::kO1) > 0.0; ++round) {
    PostureSet exchanged = set;
    exchanged.Add(problem, pool[FindMostInformative(set.information(), psi)]);
    exchanged.Remove(FindWorst(exchanged, Criterion::kO1, WorstIndex::kLeastLoss));
    if (!(exchanged.Index(Criterion::kO1) > set.Index(Criterion::kO1))) break;
    set = std::move(exchanged);
  }
  result.sizes = {set.size()};
  result.indices = {set.Index(Criterion::kO1)};
  if (result.indices[0] == 0.0) result.status = DesignResult::Status::kRankDeficient;
  return result;
}

DesignResult RandomDesign(PostureProblem& problem, int postures, std::uint64_t seed) {
  DesignResult result{PostureSet(problem.column_count())};
  for (const Eigen::VectorXd& x : DrawPool(problem, postures, seed, result)) {
    result.set.Add(problem, x);
  }
  result.sizes = {result.set.size()};
  result.indices = {result.set.Index(problem.criterion)};
  return result;
}

}  // namespace elastocal
