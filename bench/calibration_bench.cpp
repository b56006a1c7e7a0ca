// SPDX-License-Identifier: Apache-2.0
// Time of the calibration of examples/talos_left_arm, and of its analytic Jacobian compared with
// differences.
#include <filesystem>
#include <map>
#include <numeric>
#include <vector>

#include "bench/compare.hpp"
#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/calibration/fit.hpp"
#include "elastocal/io/posture_table.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

constexpr char kRecording[] = "data/talos_left_arm_mocap/talos_left_arm_02_10_contact.csv";

struct Experiment {
  Project project;
  ErrorModel model;
  BaseParameters base;
  Recording recording;
};

/// Replaces the real recording if it is absent: as many postures of the same robot, with errors
/// drawn from the prior.
Recording GenerateRecording(const ErrorModel& model, const BaseParameters& base,
                            const Prior& prior) {
  std::map<ParameterKind, double> sd;
  for (ParameterKind kind : {ParameterKind::kTheta, ParameterKind::kR, ParameterKind::kD,
                             ParameterKind::kAlpha, ParameterKind::kBeta}) {
    sd[kind] = prior[kind];
  }
  return MakeSyntheticRecording(model, DrawErrors(model, base.kept, sd, 1),
                                {.postures = 61, .marker_sd = 0.5e-3});
}

Experiment OpenExperiment(benchmark::State& state) {
  Experiment experiment;
  experiment.project = ReadProject(SourceFile("examples/talos_left_arm/project.yaml"));
  const Project& project = experiment.project;
  experiment.model = MakeErrorModel(project.tree, project.markers, project.placement);
  experiment.base = FindBaseParameters(experiment.model, project.identifiability);
  const std::filesystem::path file = SharedFile(kRecording);
  const bool real = std::filesystem::exists(file);
  experiment.recording =
      real ? ReadPostureTable(file, project).recording
           : GenerateRecording(experiment.model, experiment.base, project.calibration.prior);
  state.SetLabel(real ? "real recording" : "generated recording");
  return experiment;
}

/// The whole estimate: registration, robust fit, decision on outliers, noise and prior, covariance.
void EstimateGeometric(benchmark::State& state) {
  const Experiment e = OpenExperiment(state);
  std::vector<double> seconds;
  CalibrationResult result;
  for (auto _ : state) {  // NOLINT(clang-analyzer-deadcode.DeadStores)
    seconds.push_back(TimeOnce([&] {
      result =
          Calibrate(e.model, e.recording, e.base, ModelKind::kGeometric, e.project.calibration);
    }));
  }
  state.counters["median_s"] = MedianOf(seconds);
  state.counters["iterations"] = result.iterations;
}
BENCHMARK(EstimateGeometric)->Unit(benchmark::kMillisecond);

/// The analytic derivatives of all residuals with respect to all unknowns, compared with central
/// differences.
void LineariseAgainstDifferences(benchmark::State& state) {
  const Experiment e = OpenExperiment(state);
  const FitProblem problem{e.model, e.recording, e.project.calibration,
                           NoiseGroups(e.model, e.recording)};
  const Selection selection = SelectAll(e.model, e.recording);
  std::vector<int> free(e.model.parameters.size());
  std::iota(free.begin(), free.end(), 0);
  const Fit start = StartFit(problem, selection, Eigen::VectorXd::Zero(e.model.parameter_count()));
  FitResiduals residuals(problem, selection, free, start);
  const Eigen::VectorXd x = residuals.body.Start();
  constexpr double kStep = 1e-4;
  CompareInTurns(
      state, 1, [&] { residuals.body.Evaluate(x, true); },
      [&] {
        for (Eigen::Index i = 0; i < x.size(); ++i) {
          for (double step : {kStep, -kStep}) {
            Eigen::VectorXd beside = x;
            beside[i] += step;
            residuals.body.Evaluate(beside, false);
          }
        }
      });
}
BENCHMARK(LineariseAgainstDifferences)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace elastocal
