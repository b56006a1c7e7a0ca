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

double LogDetPlusOne(Eigen::MatrixXd M) {
  M.diagonal().array() += 1.0;
  const Eigen::LLT<Eigen::MatrixXd> factor(M);
  return 2.0 * Eigen::MatrixXd(factor.matrixL()).diagonal().array().log().sum();
}

/// The prior knowledge, with its covariance P = L L' in units of the standard deviations (angles
/// and compliances differ by orders of magnitude). B = L'AL is the worth of data with the
/// information A, relative to the prior.
class Knowledge {
 public:
  explicit Knowledge(const PriorKnowledge& prior)
      : unit_(prior.covariance.diagonal().cwiseSqrt()),
        root_(unit_.cwiseInverse().asDiagonal() * prior.covariance *
              unit_.cwiseInverse().asDiagonal()),
        change_(prior.change_sd.cwiseQuotient(unit_)) {
    for (int i = 0; i < change_.size(); ++i) {
      if (change_[i] > 0.0) changing_.push_back(i);
    }
    inverse_root_ = Eigen::MatrixXd::Identity(unit_.size(), unit_.size());
    root_.matrixL().solveInPlace(inverse_root_);
  }

  const std::vector<int>& changing() const { return changing_; }

  Eigen::MatrixXd Worth(const Eigen::MatrixXd& information) const {
    const Eigen::MatrixXd scaled = unit_.asDiagonal() * information * unit_.asDiagonal();
    const Eigen::MatrixXd reach = root_.matrixU() * scaled;  // L'A
    return root_.matrixU() * Eigen::MatrixXd(reach.transpose());
  }

  /// Information of the data on changes of the parameters that may change, when the parameters are
  /// as uncertain as P: A - A (A + P^-1)^-1 A, which is L^-T B (I + B)^-1 L^-1.
  Eigen::MatrixXd OfChanges(const Eigen::MatrixXd& worth) const {
    const Eigen::MatrixXd columns = inverse_root_(Eigen::all, changing_);
    Eigen::MatrixXd all = worth;
    all.diagonal().array() += 1.0;
    return (worth * columns).transpose() * Eigen::LLT<Eigen::MatrixXd>(all).solve(columns);
  }

  /// Information that the data are expected to give, nats.
  double Told(const Eigen::MatrixXd& worth, SequentialAim aim) const {
    if (aim == SequentialAim::kParameters) return LogDetPlusOne(worth);
    const Eigen::VectorXd size = change_(changing_);
    return LogDetPlusOne(size.asDiagonal() * OfChanges(worth) * size.asDiagonal());
  }

 private:
  Eigen::VectorXd unit_;
  Eigen::LLT<Eigen::MatrixXd> root_;
  Eigen::MatrixXd inverse_root_;
  Eigen::VectorXd change_;
  std::vector<int> changing_;
};

class Search {
 public:
  Search(PostureProblem& problem, const PriorKnowledge& prior, const SequentialOptions& options,
         const std::vector<Eigen::VectorXd>& pool)
      : knowledge_(prior), aim_(options.aim) {
    for (const Eigen::VectorXd& x : pool) {
      const Eigen::MatrixXd psi = EvaluateRegressor(problem, x) / prior.marker_sd;
      worth_.push_back(knowledge_.Worth(psi.transpose() * psi));
    }
    const auto columns = problem.column_count();
    sum_ = Eigen::MatrixXd::Zero(columns, columns);
  }

  /// The candidate that gives most information when added to the postures chosen so far.
  int Best(double& most) const {
    int best = -1;
    for (std::size_t i = 0; i < worth_.size(); ++i) {
      InterruptionPoint();
      const double value = knowledge_.Told(sum_ + worth_[i], aim_);
      if (best >= 0 && !(value > most + kLeastGain)) continue;
      most = value;
      best = static_cast<int>(i);
    }
    return best;
  }

  void Add(int candidate) { sum_ += worth_[candidate]; }
  void Remove(int candidate) { sum_ -= worth_[candidate]; }

 private:
  Knowledge knowledge_;
  SequentialAim aim_;
  std::vector<Eigen::MatrixXd> worth_;  // of each candidate
  Eigen::MatrixXd sum_;
};

}  // namespace

double ExpectedInformation(const PriorKnowledge& prior, const Eigen::MatrixXd& data,
                           SequentialAim aim) {
  const Knowledge knowledge(prior);
  return knowledge.Told(knowledge.Worth(data), aim);
}

Eigen::VectorXd ChangeDeviations(const PriorKnowledge& prior, const Eigen::MatrixXd& data) {
  const Knowledge knowledge(prior);
  const Eigen::VectorXd told = knowledge.OfChanges(knowledge.Worth(data)).diagonal();
  Eigen::VectorXd result =
      Eigen::VectorXd::Constant(prior.change_sd.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < knowledge.changing().size(); ++i) {
    const double one = told[static_cast<Eigen::Index>(i)];
    const int parameter = knowledge.changing()[i];
    if (one > 0.0) result[parameter] = std::sqrt(prior.covariance(parameter, parameter) / one);
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
