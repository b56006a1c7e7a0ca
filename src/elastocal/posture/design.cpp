// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/design.hpp"

#include <cmath>

#include "elastocal/posture/exchange.hpp"
#include "elastocal/posture/ioops.hpp"

namespace elastocal {
namespace {

void SetPostures(const PostureProblem& problem, const PostureSet& set, ChainDesign& design) {
  design.postures.clear();
  for (const Eigen::VectorXd& x : set.postures()) {
    design.postures.push_back(problem.feasible.chain.FullPosture(x));
  }
}

void Certify(PostureProblem& problem, const PostureSet& set, const DesignOptions& options,
             ChainDesign& design) {
  if (!options.certify || options.criterion != Criterion::kO1) return;
  CertificateOptions certificate = options.certificate;
  certificate.seed = options.seed;
  design.certificate = CertifyBound(problem, set, certificate);
}

/// Derives seeds for streams that must not use the same random numbers.
std::uint64_t Derived(std::uint64_t seed, int stream) {
  return seed * 1000003u + static_cast<std::uint64_t>(stream);
}

DesignResult Run(PostureProblem& problem, const DesignOptions& options) {
  if (options.algorithm == DesignAlgorithm::kNocp) return Nocp(problem, options.seed, options.nocp);
  const std::uint64_t seed = Derived(options.seed, options.postures);
  if (options.algorithm == DesignAlgorithm::kExchange) {
    return ExchangeDesign(problem, options.postures, seed);
  }
  DesignResult result = RandomDesign(problem, options.postures, seed);
  if (result.indices[0] == 0.0 || options.algorithm == DesignAlgorithm::kRandom) return result;
  if (options.algorithm == DesignAlgorithm::kCocp) {
    Cocp(problem, result.set);
  } else {
    Ioops(problem, result.set, Derived(options.seed, -options.postures));
  }
  result.indices = {result.set.Index(problem.criterion)};
  return result;
}

}  // namespace

const char* AlgorithmName(DesignAlgorithm algorithm) {
  static constexpr const char* kNames[] = {"nocp", "cocp", "ioops", "exchange", "random"};
  return kNames[static_cast<int>(algorithm)];
}

void SetPostureCount(int count, DesignOptions& options) {
  options.postures = count;
  options.nocp.plateau.max_postures = count;
  options.nocp.plateau.tolerance = -1.0;  // no plateau
}

ChainDesign DesignChain(const ErrorModel& model, const std::vector<int>& base,
                        const MotionSetup& motion, const ChainSetup& chain,
                        const DesignOptions& options) {
  PostureProblem problem = MakeChainProblem(model, base, motion, chain, options.criterion);
  const DesignResult result = Run(problem, options);
  ChainDesign design;
  design.setup = chain;
  design.status = result.status;
  design.blame = result.blame;
  design.parameter_count = problem.column_count();
  design.index = result.set.Index(options.criterion);
  design.sizes = result.sizes;
  design.indices = result.indices;
  design.sampling = result.sampling;
  SetPostures(problem, result.set, design);
  if (design.index > 0.0) Certify(problem, result.set, options, design);
  return design;
}

ChainDesign MirrorDesign(const ChainDesign& design, const MirrorMap& mirror,
                         const ErrorModel& model, const std::vector<int>& base,
                         const MotionSetup& motion, const ChainSetup& other,
                         const DesignOptions& options) {
  PostureProblem problem = MakeChainProblem(model, base, motion, other, options.criterion);
  PostureSet set(problem.column_count());
  ChainDesign mirrored;
  FeasibleSampler sampler(problem.feasible, Derived(options.seed, 1));
  std::vector<int> replaced;
  for (const Eigen::VectorXd& q : design.postures) {
    Eigen::VectorXd x = mirror.sign.cwiseProduct(q(design.setup.coordinates));
    const Violation violation = WorstViolation(problem.feasible, x);
    if (violation.amount > kFeasible) {
      const auto drawn = sampler.Draw();
      if (!drawn) {
        mirrored.notes.push_back("a posture was left out: its mirror image " +
                                 violation.Describe());
        continue;
      }
      mirrored.notes.push_back("posture " + std::to_string(set.size() + 1) +
                               " was replaced: its mirror image " + violation.Describe());
      replaced.push_back(set.size());
      x = *drawn;
    }
    set.Add(problem, x);
  }
  if (!replaced.empty() && set.Index(options.criterion) > 0.0) {
    PartialOptim(problem, replaced, set, options.nocp.cocp.partial);
  }
  mirrored.setup = other;
  mirrored.status = design.status;
  mirrored.parameter_count = problem.column_count();
  mirrored.index = set.Index(options.criterion);
  mirrored.mirrored_from = design.setup.name;
  // The feasible set is a mirror image as far as the robot is symmetric, so the certificate is
  // taken over.
  mirrored.certificate = design.certificate;
  SetPostures(problem, set, mirrored);
  return mirrored;
}

std::vector<CurvePoint> CompareAlgorithms(const ErrorModel& model, const std::vector<int>& base,
                                          const MotionSetup& motion, const ChainSetup& chain,
                                          const std::vector<int>& sizes,
                                          const DesignOptions& options) {
  PostureProblem problem = MakeChainProblem(model, base, motion, chain, options.criterion);
  std::vector<CurvePoint> points;
  for (int size : sizes) {
    for (DesignAlgorithm algorithm : {DesignAlgorithm::kCocp, DesignAlgorithm::kIoops,
                                      DesignAlgorithm::kExchange, DesignAlgorithm::kRandom}) {
      if (algorithm == DesignAlgorithm::kExchange && options.criterion != Criterion::kO1) continue;
      DesignOptions one = options;
      one.algorithm = algorithm;
      one.postures = size;
      const DesignResult result = Run(problem, one);
      points.push_back({algorithm, chain.name, size, result.set.Index(options.criterion)});
    }
  }
  return points;
}

}  // namespace elastocal
