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

/// Seeds of what shall not see the same random numbers.
std::uint64_t Derived(std::uint64_t seed, int stream) {
  return seed * 1000003u + static_cast<std::uint64_t>(stream);
}

}  // namespace

ChainDesign DesignChain(const ErrorModel& model, const std::vector<int>& base,
                        const MotionSetup& motion, const ChainSetup& chain,
                        const DesignOptions& options) {
  PostureProblem problem = MakeChainProblem(model, base, motion, chain, options.criterion);
  const DesignResult result = Nocp(problem, options.seed, options.nocp);
  ChainDesign design;
  design.setup = chain;
  design.status = result.status;
  design.blame = result.blame;
  design.parameter_count = problem.column_count();
  design.index = result.set.Index(options.criterion);
  design.sizes = result.sizes;
  design.indices = result.indices;
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
        mirrored.notes.push_back("a posture was left out: " + violation.what);
        continue;
      }
      mirrored.notes.push_back("posture " + std::to_string(set.size() + 1) +
                               " was found anew: mirrored, it breaks the " + violation.what);
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
  // The feasible set is the mirror image as far as the robot is one.
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
  const auto add = [&](const char* algorithm, const PostureSet& set) {
    points.push_back({algorithm, chain.name, set.size(), set.Index(options.criterion)});
  };
  for (int size : sizes) {
    const DesignResult random = RandomDesign(problem, size, Derived(options.seed, size));
    if (random.status == DesignResult::Status::kNoPosture) break;
    add("random", random.set);
    if (options.criterion == Criterion::kO1) {
      add("exchange", ExchangeDesign(problem, size, Derived(options.seed, size)).set);
    }
    if (random.indices[0] == 0.0) continue;  // too few to start from
    PostureSet cocp = random.set;
    Cocp(problem, cocp, options.nocp.cocp);
    add("cocp", cocp);
    PostureSet ioops = random.set;
    Ioops(problem, ioops, Derived(options.seed, -size));
    add("ioops", ioops);
  }
  return points;
}

}  // namespace elastocal
