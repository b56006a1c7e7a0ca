// SPDX-License-Identifier: Apache-2.0
// Time of a controller's calls of the robot at run time, for the whole TALOS.
#include <benchmark/benchmark.h>

#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/runtime/compensator.hpp"
#include "tests/runtime_calibration.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

struct Calls {
  Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  Compensator robot{MakeRuntimeModel(project, RandomCalibration(project, 1))};
  Eigen::VectorXd q = project.motion.rest, none;
};

void Forward(benchmark::State& state) {
  Calls calls;
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    benchmark::DoNotOptimize(calls.robot.Forward(calls.q, calls.none, 1));
  }
}
BENCHMARK(Forward)->Unit(benchmark::kMicrosecond);

void Correct(benchmark::State& state) {
  Calls calls;
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    benchmark::DoNotOptimize(calls.robot.Correct(calls.q, calls.none, 1));
  }
}
BENCHMARK(Correct)->Unit(benchmark::kMicrosecond);

/// Calls along a motion: all joints go to and fro by 0.1 rad, with 1 mrad a call.
void Command(benchmark::State& state) {
  constexpr double kStep = 1e-3;
  constexpr int kSteps = 100;
  Calls calls;
  int call = 0;
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    calls.q.array() += call++ / kSteps % 2 == 0 ? -kStep : kStep;
    benchmark::DoNotOptimize(calls.robot.Command(calls.q, calls.none, 1));
  }
}
BENCHMARK(Command)->Unit(benchmark::kMicrosecond);

/// Each call is independent of the others.
void CommandAlone(benchmark::State& state) {
  Calls calls;
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    calls.robot.Forget();
    benchmark::DoNotOptimize(calls.robot.Command(calls.q, calls.none, 1));
  }
}
BENCHMARK(CommandAlone)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace elastocal
