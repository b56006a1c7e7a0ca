// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/certificate.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Cholesky>

#include "elastocal/math/interruption.hpp"
#include "elastocal/nlp/nonlinear_program.hpp"

namespace elastocal {
namespace {

constexpr double kLeastWeight = 1e-6;  // a posture with less weight leaves the set
constexpr int kWeightIterations = 300;
constexpr double kWeightTolerance = 1e-3;  // relative tolerance of phi over the weighted postures

Eigen::MatrixXd Inverse(const Eigen::MatrixXd& M) {
  return M.llt().solve(Eigen::MatrixXd::Identity(M.rows(), M.cols()));
}

/// phi(q) with a fixed M^-1.
class VarianceProgram : public NonlinearProgram {
 public:
  VarianceProgram(PostureProblem& problem, const Eigen::MatrixXd& inverse)
      : problem_(problem), inverse_(inverse), jacobian_(1) {
    lower = problem.feasible.lower;
    upper = problem.feasible.upper;
    constraint_lower = problem.feasible.ConstraintLower();
    constraint_upper = problem.feasible.ConstraintUpper();
    jacobian_blocks = {{0, problem.feasible.constraint_count(), 0, problem.variable_count()}};
  }
  bool Evaluate(const Eigen::VectorXd& x) override {
    psi_ = EvaluateRegressor(problem_, x);
    weighted_ = psi_ * inverse_;
    EvaluateConstraints(problem_.feasible, x, values_, jacobian_[0]);
    return true;
  }
  double Variance() const { return psi_.cwiseProduct(weighted_).sum(); }
  double Objective() const override { return -Variance() / static_cast<double>(inverse_.cols()); }
  Eigen::VectorXd Gradient() override {
    return -2.0 / static_cast<double>(inverse_.cols()) *
           problem_.regressor.Gradient(problem_.feasible.chain, weighted_);
  }
  const Eigen::VectorXd& Constraints() const override { return values_; }
  const std::vector<Eigen::MatrixXd>& Jacobian() const override { return jacobian_; }

 private:
  PostureProblem& problem_;
  const Eigen::MatrixXd& inverse_;
  Eigen::VectorXd values_;
  Eigen::MatrixXd psi_, weighted_;
  std::vector<Eigen::MatrixXd> jacobian_;
};

/// A weighted set: postures, by their information Psi^T Psi, with weights that sum to one.
class WeightedSet {
 public:
  WeightedSet(PostureProblem& problem, const std::vector<Eigen::VectorXd>& postures)
      : weights_(Eigen::VectorXd::Constant(static_cast<Eigen::Index>(postures.size()),
                                           1.0 / static_cast<double>(postures.size()))) {
    for (const Eigen::VectorXd& x : postures) {
      const Eigen::MatrixXd psi = EvaluateRegressor(problem, x);
      parts_.emplace_back(psi.transpose() * psi);
    }
  }

  int size() const { return static_cast<int>(parts_.size()); }
  void Add(const Eigen::MatrixXd& psi) {
    parts_.emplace_back(psi.transpose() * psi);
    const Eigen::Index count = weights_.size() + 1;
    weights_ *= 1.0 - 1.0 / static_cast<double>(count);
    weights_.conservativeResize(count);
    weights_[count - 1] = 1.0 / static_cast<double>(count);
  }

  Eigen::MatrixXd Information() const {
    Eigen::MatrixXd M = weights_[0] * parts_[0];
    for (int k = 1; k < size(); ++k) M += weights_[k] * parts_[k];
    return M;
  }

  /// The multiplicative algorithm (Silvey, Titterington and Torsney 1978) multiplies weights by phi
  /// / N_b, which never lowers the determinant.
  void OptimiseWeights() {
    for (int i = 0; i < kWeightIterations; ++i) {
      InterruptionPoint();
      const Eigen::MatrixXd inverse = Inverse(Information());
      Eigen::VectorXd ratio(size());
      for (int k = 0; k < size(); ++k) {
        ratio[k] = inverse.cwiseProduct(parts_[k]).sum() / static_cast<double>(inverse.cols());
      }
      weights_.array() *= ratio.array();
      weights_ /= weights_.sum();
      if (ratio.maxCoeff() < 1.0 + kWeightTolerance) break;
    }
    Drop();
  }

 private:
  void Drop() {
    std::vector<Eigen::MatrixXd> kept;
    std::vector<double> weights;
    for (int k = 0; k < size(); ++k) {
      if (weights_[k] < kLeastWeight) continue;
      kept.push_back(parts_[k]);
      weights.push_back(weights_[k]);
    }
    parts_ = std::move(kept);
    weights_ =
        Eigen::Map<Eigen::VectorXd>(weights.data(), static_cast<Eigen::Index>(weights.size()));
    weights_ /= weights_.sum();
  }

  std::vector<Eigen::MatrixXd> parts_;
  Eigen::VectorXd weights_;
};

}  // namespace

Certificate CertifyBound(PostureProblem& problem, const PostureSet& set,
                         const CertificateOptions& options) {
  if (problem.criterion != Criterion::kO1) {
    throw std::invalid_argument("CertifyBound: only O1 has a bound");
  }
  Certificate certificate;
  if (set.Index(Criterion::kO1) == 0.0) return certificate;
  FeasibleSampler sampler(problem.feasible, options.seed);
  // The bound is that of the feasible postures, which those given may not all be.
  std::vector<Eigen::VectorXd> pool;
  for (const Eigen::VectorXd& x : set.postures()) {
    if (WorstViolation(problem.feasible, x).amount <= kFeasible) pool.push_back(x);
  }
  const bool all_feasible = static_cast<int>(pool.size()) == set.size();
  while (static_cast<int>(pool.size()) < options.candidates + set.size()) {
    const auto drawn = sampler.Draw();
    if (!drawn) break;
    pool.push_back(*drawn);
  }
  WeightedSet weighted(problem, all_feasible ? set.postures() : pool);
  certificate.bound = std::numeric_limits<double>::infinity();
  for (; certificate.rounds < options.max_rounds; ++certificate.rounds) {
    weighted.OptimiseWeights();
    const Eigen::MatrixXd information = weighted.Information();
    const Eigen::MatrixXd inverse = Inverse(information);
    const double o1 = O1(LogDet(information), problem.column_count(), 1);
    VarianceProgram program(problem, inverse);
    std::vector<std::pair<double, int>> ranked;
    for (std::size_t i = 0; i < pool.size(); ++i) {
      program.Evaluate(pool[i]);
      ranked.emplace_back(-program.Variance(), static_cast<int>(i));
    }
    std::sort(ranked.begin(), ranked.end());
    double most = -ranked.front().first;
    std::vector<Eigen::VectorXd> found;
    const int starts = std::min<int>(options.starts, static_cast<int>(ranked.size()));
    for (int s = 0; s < starts; ++s) {
      NonlinearProgramOptions solver;
      solver.tolerance = 1e-4;
      solver.max_iterations = 60;
      const Eigen::VectorXd x = Solve(program, pool[ranked[s].second], solver).x;
      if (WorstViolation(problem.feasible, x).amount > kFeasible) continue;
      program.Evaluate(x);
      most = std::max(most, program.Variance());
      if (program.Variance() > problem.column_count()) found.push_back(x);
    }
    const double ratio = most / problem.column_count();
    certificate.bound = std::min(certificate.bound, o1 * std::sqrt(std::max(1.0, ratio)));
    certificate.attained = o1;
    certificate.weighted_postures = weighted.size();
    if (certificate.bound < o1 * (1.0 + options.gap) || found.empty()) break;
    for (const Eigen::VectorXd& x : found) {
      pool.push_back(x);
      weighted.Add(EvaluateRegressor(problem, x));
    }
  }
  return certificate;
}

}  // namespace elastocal
