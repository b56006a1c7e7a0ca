// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/sequential.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "elastocal/math/interruption.hpp"
#include "elastocal/posture/exchange.hpp"

namespace elastocal {
namespace {

constexpr double kLeastGain = 1e-6;  // nats, of an exchange

/// Of all parameters in units of their standard deviations: angles and compliances differ by orders
/// of magnitude.
struct Scaled {
  Eigen::MatrixXd data, covariance;
  Eigen::VectorXd change;

  Scaled(const PriorKnowledge& prior, const Eigen::MatrixXd& information) {
    const Eigen::VectorXd unit = prior.covariance.diagonal().cwiseSqrt();
    data = unit.asDiagonal() * information * unit.asDiagonal();
    covariance =
        unit.cwiseInverse().asDiagonal() * prior.covariance * unit.cwiseInverse().asDiagonal();
    change = prior.change_sd.cwiseQuotient(unit);
  }
};

double LogDetPlusOne(Eigen::MatrixXd M) {
  M.diagonal().array() += 1.0;
  const Eigen::LLT<Eigen::MatrixXd> factor(M);
  return 2.0 * Eigen::MatrixXd(factor.matrixL()).diagonal().array().log().sum();
}

/// What the data say of changes, beside the parameters: A - A (A + P^-1)^-1 A with P = L L', which
/// is A - A L (I + L'AL)^-1 L'A.
Eigen::MatrixXd Beside(const Scaled& scaled) {
  const Eigen::LLT<Eigen::MatrixXd> root(scaled.covariance);
  const Eigen::MatrixXd reach = root.matrixU() * scaled.data;  // L'A
  Eigen::MatrixXd inner = root.matrixU() * Eigen::MatrixXd(reach.transpose());
  inner.diagonal().array() += 1.0;
  return scaled.data - reach.transpose() * Eigen::LLT<Eigen::MatrixXd>(inner).solve(reach);
}

class Search {
 public:
  Search(PostureProblem& problem, const PriorKnowledge& prior, const SequentialOptions& options,
         const std::vector<Eigen::VectorXd>& pool)
      : prior_(prior), options_(options) {
    for (const Eigen::VectorXd& x : pool) {
      const Eigen::MatrixXd psi = EvaluateRegressor(problem, x) / prior.marker_sd;
      information_.emplace_back(psi.transpose() * psi);
    }
    const auto columns = problem.column_count();
    sum_ = Eigen::MatrixXd::Zero(columns, columns);
  }

  /// The candidate that gives most, added to what is there.
  int Best(double& most) const {
    int best = -1;
    for (std::size_t i = 0; i < information_.size(); ++i) {
      InterruptionPoint();
      const double value = ExpectedInformation(prior_, sum_ + information_[i], options_.aim);
      if (best >= 0 && !(value > most + kLeastGain)) continue;
      most = value;
      best = static_cast<int>(i);
    }
    return best;
  }

  void Add(int candidate) { sum_ += information_[candidate]; }
  void Remove(int candidate) { sum_ -= information_[candidate]; }

 private:
  const PriorKnowledge& prior_;
  const SequentialOptions& options_;
  std::vector<Eigen::MatrixXd> information_;
  Eigen::MatrixXd sum_;
};

}  // namespace

double ExpectedInformation(const PriorKnowledge& prior, const Eigen::MatrixXd& data,
                           SequentialAim aim) {
  const Scaled scaled(prior, data);
  if (aim == SequentialAim::kParameters) {
    const Eigen::LLT<Eigen::MatrixXd> root(scaled.covariance);
    const Eigen::MatrixXd reach = root.matrixU() * scaled.data;
    return LogDetPlusOne(root.matrixU() * Eigen::MatrixXd(reach.transpose()));
  }
  std::vector<int> changing;
  for (int i = 0; i < scaled.change.size(); ++i) {
    if (scaled.change[i] > 0.0) changing.push_back(i);
  }
  const Eigen::MatrixXd left = Beside(scaled);
  const Eigen::VectorXd size = scaled.change(changing);
  return LogDetPlusOne(size.asDiagonal() * left(changing, changing) * size.asDiagonal());
}

Eigen::VectorXd ChangeDeviations(const PriorKnowledge& prior, const Eigen::MatrixXd& data) {
  const Scaled scaled(prior, data);
  const Eigen::VectorXd told = Beside(scaled).diagonal();
  Eigen::VectorXd result =
      Eigen::VectorXd::Constant(told.size(), std::numeric_limits<double>::infinity());
  for (Eigen::Index i = 0; i < told.size(); ++i) {
    if (scaled.change[i] > 0.0 && told[i] > 0.0) {
      result[i] = std::sqrt(prior.covariance(i, i) / told[i]);
    }
  }
  return result;
}

DesignResult SequentialDesign(PostureProblem& problem, const PriorKnowledge& prior,
                              std::uint64_t seed, const SequentialOptions& options) {
  DesignResult result{PostureSet(problem.column_count())};
  const std::vector<Eigen::VectorXd> pool = DrawPool(problem, options.pool, seed, result);
  if (pool.empty()) return result;

  Search search(problem, prior, options, pool);
  std::vector<int> chosen;
  double information = 0.0;
  for (int k = 0; k < options.postures; ++k) {
    chosen.push_back(search.Best(information));
    search.Add(chosen.back());
    result.sizes.push_back(k + 1);
    result.indices.push_back(information);
  }
  bool improved = true;
  for (int round = 0; round < options.max_rounds && improved; ++round) {
    improved = false;
    for (int& one : chosen) {
      search.Remove(one);
      double most = 0.0;
      const int best = search.Best(most);
      if (most > information + kLeastGain) {
        one = best;
        information = most;
        improved = true;
      }
      search.Add(one);
    }
  }
  result.indices.back() = information;
  for (int one : chosen) result.set.Add(problem, pool[one]);
  return result;
}

}  // namespace elastocal
