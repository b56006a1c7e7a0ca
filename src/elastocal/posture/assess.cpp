// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/assess.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "elastocal/math/decompositions.hpp"
#include "elastocal/posture/partial_optim.hpp"

namespace elastocal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSingular = 1e-12;  // eigenvalues below this share of the largest are zero

/// Standard deviations by eigenvalues. They are infinite for parameters that the set does not
/// determine.
Eigen::VectorXd StandardDeviations(const Eigen::MatrixXd& information, double marker_sd) {
  const SymmetricDecomposition eigen = DecomposeSymmetric(information);
  const double floor = kSingular * eigen.values.maxCoeff();
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(information.rows());
  for (Eigen::Index k = 0; k < variance.size(); ++k) {
    const Eigen::ArrayXd share = eigen.vectors.col(k).array().square();
    if (eigen.values[k] > floor) {
      variance.array() += share / eigen.values[k];
    } else {
      for (Eigen::Index i = 0; i < variance.size(); ++i) {
        if (share[i] > 1e-12) variance[i] = kInfinity;
      }
    }
  }
  return marker_sd * variance.cwiseSqrt();
}

void SearchAddition(PostureProblem& problem, const PostureSet& set, const AssessOptions& options,
                    Assessment& assessment) {
  FeasibleSampler sampler(problem.feasible, options.seed);
  for (int start = 0; start < options.starts; ++start) {
    const auto drawn = sampler.Draw();
    if (!drawn) return;
    PostureSet larger = set;
    larger.Add(problem, *drawn);
    PartialOptim(problem, {set.size()}, larger);
    const double o1 = larger.Index(Criterion::kO1);
    if (o1 > assessment.o1_with_addition) {
      assessment.o1_with_addition = o1;
      assessment.best_addition = larger.posture(set.size());
    }
  }
}

}  // namespace

Assessment AssessPostures(PostureProblem& problem, const PostureSet& set,
                          const AssessOptions& options) {
  Assessment assessment;
  for (const Eigen::VectorXd& x : set.postures()) {
    assessment.violations.push_back(WorstViolation(problem.feasible, x));
  }
  assessment.parameter_sd = StandardDeviations(set.information(), options.marker_sd);
  if (set.Index(Criterion::kO1) > 0.0) {
    const Eigen::VectorXd sigma = SymmetricValues(set.information()).cwiseMax(0.0).cwiseSqrt();
    assessment.indices = ComputeObservability(sigma, set.size());
    const double root = std::sqrt(set.size());
    const Eigen::VectorXd without = IndicesWithoutEach(set, Criterion::kO1);
    assessment.loss = (1.0 - without.array() * std::sqrt(std::max(1, set.size() - 1)) /
                                 (assessment.indices.o1 * root))
                          .matrix();
    Eigen::Index least = 0;
    assessment.loss.minCoeff(&least);
    assessment.adds_least = static_cast<int>(least);
    assessment.certificate = CertifyBound(problem, set, options.certificate);
    assessment.efficiency = assessment.indices.o1 / assessment.certificate.bound;
  }
  SearchAddition(problem, set, options, assessment);
  return assessment;
}

}  // namespace elastocal
