// SPDX-License-Identifier: Apache-2.0
// Planning motions: time for several numbers of postures, and the duration of the motion.
#include <benchmark/benchmark.h>

#include "elastocal/motion/plan.hpp"
#include "elastocal/motion/validation_tours.hpp"
#include "elastocal/project/project.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

std::unique_ptr<StandingRobot> StandTalos(const Project& project) {
  auto robot = std::make_unique<StandingRobot>(project.tree, project.soles, MotionLimits{});
  std::vector<SpherePair> pairs;
  for (const ChainSetup& chain : project.motion.chains) {
    pairs.insert(pairs.end(), chain.contacts.begin(), chain.contacts.end());
  }
  robot->clearances = [&tree = robot->tree, &spheres = project.motion.spheres,
                       pairs](const Eigen::VectorXd& q) {
    return SphereDistances(spheres, pairs, LinkTransforms(tree, q));
  };
  StandUp(*robot, project.motion.rest, {});
  return robot;
}

/// As many random postures of an arm as of a leg.
void PlanPostures(benchmark::State& state) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  const auto robot = StandTalos(project);
  Random random(1);
  const auto sets =
      ValidationTours(*robot, project.motion, project.motion.chains, ValidationKind::kRandom,
                      {.random_postures = static_cast<int>(state.range(0))}, random);
  double seconds = 0.0;
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    const auto planned = PlanTours(*robot, sets, {}, 2);
    seconds = static_cast<double>(JoinMotions(*robot, planned, 0.0, 100.0).q.rows()) / 100.0;
  }
  state.counters["motion_s"] = seconds;
  state.SetComplexityN(static_cast<int>(seconds));
}
BENCHMARK(PlanPostures)
    ->Arg(4)
    ->Arg(8)
    ->Arg(16)
    ->Arg(32)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime()
    ->Complexity(benchmark::oN);

}  // namespace
}  // namespace elastocal
