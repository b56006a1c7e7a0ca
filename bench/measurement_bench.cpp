// SPDX-License-Identifier: Apache-2.0
// Time from raw files to samples for a recording of ten minutes, and for half and a quarter of it.
// Times are wall-clock times, because reading uses two threads.
#include <filesystem>
#include <map>
#include <memory>
#include <numeric>

#include <benchmark/benchmark.h>

#include "elastocal/files/output_files.hpp"
#include "elastocal/io/joint_log.hpp"
#include "elastocal/io/recording_folder.hpp"
#include "elastocal/measurement/smoothed_log.hpp"
#include "elastocal/measurement/trial_clock.hpp"
#include "elastocal/readers/qtm_tsv.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"
#include "tests/trial_player.hpp"

namespace elastocal {
namespace {

constexpr char kExperiment[] =
    "trials:\n"
    "  - name: all\n"
    "    chains: [head_trunk, torso_arm_left, torso_arm_right, leg_left, leg_right]\n"
    "    support: [right_sole_link]\n"
    "    markers: all.tsv\n"
    "    joints: all.csv\n";

const Project& Talos() {
  static const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  return project;
}

/// A trial of all chains at 100 Hz with a posture every 5 s: 63 markers, 30 joints, 24 torques.
struct Played {
  explicit Played(int frames) {
    PlayOptions options{.postures = frames / 500, .lag_s = 4.0, .drift_ppm = 20.0};
    options.log_rate_hz = 100.0;
    options.standing = FindLink(Talos().tree, "right_sole_link");
    const MarkedRobot robot = MakeMarkedRobot(Talos());
    trial = Play(robot, options);
    for (int marker = 0; marker < trial.markers.marker_count(); ++marker) {
      for (int gap = 37 * marker; gap + 50 < frames; gap += 1000) {
        Hide(trial.markers, marker,
             std::min<Eigen::Index>(gap, trial.markers.positions.rows() - 50),
             marker % 2 == 0 ? 10 : 50);
      }
    }
    for (Eigen::Index c = 0; c < trial.log.torques.cols(); ++c) {
      const int joint = FindJoint(Talos().tree, trial.log.names[static_cast<std::size_t>(c)]);
      const auto& sensors = Talos().torque_sensors;
      if (std::find(sensors.begin(), sensors.end(), joint) == sensors.end()) {
        trial.log.torques.col(c).setConstant(std::numeric_limits<double>::quiet_NaN());
      }
    }
    WriteQtmTsv(folder.path() / "all.tsv", trial.markers);
    WriteJointLog(folder.path() / "all.csv", trial.log);
    WriteFile(folder.path() / "experiment.yaml", kExperiment);
  }

  ScratchFolder folder;
  ScriptedTrial trial;
};

const Played& Recorded(benchmark::State& state) {
  static std::map<int, std::unique_ptr<Played>> recorded;
  std::unique_ptr<Played>& played = recorded[static_cast<int>(state.range(0))];
  if (!played) played = std::make_unique<Played>(static_cast<int>(state.range(0)));
  return *played;
}

void CountMegabytes(benchmark::State& state, const std::filesystem::path& file) {
  state.counters["MB"] = 1e-6 * static_cast<double>(std::filesystem::file_size(file));
}

void ReadMarkers(benchmark::State& state) {
  const Played& played = Recorded(state);
  const auto file = played.folder.path() / "all.tsv";
  // NOLINTNEXTLINE(clang-analyzer-deadcode.DeadStores)
  for (auto _ : state) benchmark::DoNotOptimize(ReadQtmTsv(file));
  CountMegabytes(state, file);
}

void ReadJoints(benchmark::State& state) {
  const Played& played = Recorded(state);
  const auto file = played.folder.path() / "all.csv";
  // NOLINTNEXTLINE(clang-analyzer-deadcode.DeadStores)
  for (auto _ : state) benchmark::DoNotOptimize(ReadJointLog(file, Talos()));
  CountMegabytes(state, file);
}

/// The steps of SampleTrial one by one, with markers and log in memory.
void CorrectTheLabels(benchmark::State& state) {
  const Played& played = Recorded(state);
  const MarkedRobot robot = MakeMarkedRobot(Talos());
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    state.PauseTiming();
    MarkerTrajectories markers = played.trial.markers;
    state.ResumeTiming();
    benchmark::DoNotOptimize(CorrectLabels(robot.clusters, {}, markers));
  }
}

void SmoothTheMarkers(benchmark::State& state) {
  const Played& played = Recorded(state);
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    state.PauseTiming();
    MarkerTrajectories markers = played.trial.markers;
    state.ResumeTiming();
    benchmark::DoNotOptimize(SmoothTrajectories({}, markers));
  }
}

void SmoothTheLog(benchmark::State& state) {
  const Played& played = Recorded(state);
  // NOLINTNEXTLINE(clang-analyzer-deadcode.DeadStores)
  for (auto _ : state) benchmark::DoNotOptimize(SmoothLog(played.trial.log, {}));
}

void PredictTheSpeeds(benchmark::State& state) {
  const Played& played = Recorded(state);
  const MarkedRobot robot = MakeMarkedRobot(Talos());
  const SmoothedLog log = SmoothLog(played.trial.log, {});
  const std::vector<int> coordinates = LoggedCoordinates(robot.tree, played.trial.log);
  std::vector<int> markers(robot.markers.size());
  std::iota(markers.begin(), markers.end(), 0);
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    benchmark::DoNotOptimize(PredictSpeeds(robot, markers, {0}, log, coordinates, 100.0));
  }
}

void SampleTheTrial(benchmark::State& state) {
  const Played& played = Recorded(state);
  const MarkedRobot robot = MakeMarkedRobot(Talos());
  Trial trial{.name = "all", .chains = {}, .support = {}};
  trial.support = {FindLink(Talos().tree, "right_sole_link")};
  std::vector<int> markers(robot.markers.size());
  std::iota(markers.begin(), markers.end(), 0);
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    state.PauseTiming();
    MarkerTrajectories trajectories = played.trial.markers;
    state.ResumeTiming();
    const TrialSamples samples =
        SampleTrial(robot, trial, markers, std::move(trajectories), played.trial.log, {});
    if (!samples.summary.refused.empty()) state.SkipWithError(samples.summary.refused.c_str());
  }
}

/// All steps, from files.
void ReadFolder(benchmark::State& state) {
  const Played& played = Recorded(state);
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    const RecordingFolder folder = ReadRecordingFolders({played.folder.path()}, Talos());
    state.counters["postures"] = folder.calibration.posture_count();
    state.counters["samples"] = folder.trials[0].samples;
  }
}

void Lengths(benchmark::internal::Benchmark* benchmark) {
  benchmark->Arg(15000)->Arg(30000)->Arg(60000)->Unit(benchmark::kMillisecond)->UseRealTime();
}
BENCHMARK(ReadMarkers)->Apply(Lengths);
BENCHMARK(ReadJoints)->Apply(Lengths);
BENCHMARK(CorrectTheLabels)->Apply(Lengths);
BENCHMARK(SmoothTheMarkers)->Apply(Lengths);
BENCHMARK(SmoothTheLog)->Apply(Lengths);
BENCHMARK(PredictTheSpeeds)->Apply(Lengths);
BENCHMARK(SampleTheTrial)->Apply(Lengths);
BENCHMARK(ReadFolder)->Apply(Lengths);

}  // namespace
}  // namespace elastocal
