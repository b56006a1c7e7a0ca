// SPDX-License-Identifier: Apache-2.0
// Calibration postures of a leg with all constraints: time and result (counter O1) of NOCP, and of
// exchange from a pool of random postures in the same run. Each uses one thread.
#include <algorithm>

#include <benchmark/benchmark.h>

#include "elastocal/posture/chain_problem.hpp"
#include "elastocal/posture/exchange.hpp"
#include "elastocal/project/project.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

constexpr int kPostures = 24;

/// The left leg of the embedded humanoid.
struct Leg {
  Leg() {
    const Chain& chain = *std::find_if(project.chains.begin(), project.chains.end(),
                                       [](const Chain& c) { return c.name == "leg_left"; });
    model = SelectMarkers(MakeErrorModel(project.tree, project.markers, project.placement),
                          ChainMarkers(project, chain));
    setup = *std::find_if(project.motion.chains.begin(), project.motion.chains.end(),
                          [](const ChainSetup& c) { return c.name == "leg_left"; });
    base = FindChainParameters(model, project.motion, setup, project.identifiability).kept;
  }
  PostureProblem Problem() const { return MakeChainProblem(model, base, project.motion, setup); }

  Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  ErrorModel model;
  ChainSetup setup;
  std::vector<int> base;
};

/// The largest number of postures is the argument.
void NocpUpTo(benchmark::State& state) {
  const Leg leg;
  PostureProblem problem = leg.Problem();
  NocpOptions options;
  options.plateau = {.tolerance = -1.0, .max_postures = static_cast<int>(state.range(0))};
  double o1 = 0.0;
  // NOLINTNEXTLINE(clang-analyzer-deadcode.DeadStores)
  for (auto _ : state) o1 = Nocp(problem, 1, options).set.Index(Criterion::kO1);
  state.counters["O1"] = o1;
}
BENCHMARK(NocpUpTo)->Arg(8)->Arg(kPostures)->Unit(benchmark::kMillisecond);

void NocpToPlateau(benchmark::State& state) {
  const Leg leg;
  PostureProblem problem = leg.Problem();
  double o1 = 0.0, postures = 0.0;
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    const DesignResult result = Nocp(problem, 1);
    o1 = result.set.Index(Criterion::kO1);
    postures = result.set.size();
  }
  state.counters["O1"] = o1;
  state.counters["postures"] = postures;
}
BENCHMARK(NocpToPlateau)->Unit(benchmark::kMillisecond);

void ExchangeFromPoolOf1000(benchmark::State& state) {
  const Leg leg;
  PostureProblem problem = leg.Problem();
  double o1 = 0.0;
  // NOLINTNEXTLINE(clang-analyzer-deadcode.DeadStores)
  for (auto _ : state) o1 = ExchangeDesign(problem, kPostures, 1).indices[0];
  state.counters["O1"] = o1;
}
BENCHMARK(ExchangeFromPoolOf1000)->Unit(benchmark::kMillisecond);

void RegressorWithGradient(benchmark::State& state) {
  const Leg leg;
  PostureProblem problem = leg.Problem();
  const Eigen::VectorXd x = leg.project.motion.rest(leg.setup.coordinates);
  Eigen::MatrixXd weight = Eigen::MatrixXd::Ones(problem.regressor.rows(), problem.column_count());
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    benchmark::DoNotOptimize(problem.regressor.Evaluate(problem.feasible.chain, x));
    benchmark::DoNotOptimize(problem.regressor.Gradient(problem.feasible.chain, weight));
  }
}
BENCHMARK(RegressorWithGradient);

}  // namespace
}  // namespace elastocal
