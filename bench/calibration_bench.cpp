// The calibration of examples/talos_left_arm: how long the estimate takes, and how much of that the
// analytic Jacobian saves against Ceres' own numeric differentiation of the same problem.
#include <cmath>
#include <filesystem>
#include <map>
#include <vector>

#include <ceres/ceres.h>

#include "bench/compare.hpp"
#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/io/posture_table.hpp"
#include "elastocal/io/project.hpp"
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

/// Where the real recording is absent, one of its shape: as many postures of the same robot, errors
/// as large as the prior expects.
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

/// The whole estimate: registration, robust fit, verdict on outliers, noise and prior, covariance.
void EstimateGeometric(benchmark::State& state) {
  const Experiment e = OpenExperiment(state);
  std::vector<double> seconds;
  CalibrationResult result;
  for (auto _ : state) {
    seconds.push_back(TimeOnce([&] {
      result =
          Calibrate(e.model, e.recording, e.base, ModelKind::kGeometric, e.project.calibration);
    }));
  }
  state.counters["median_s"] = MedianOf(seconds);
  state.counters["iterations"] = result.iterations;
}
BENCHMARK(EstimateGeometric)->Unit(benchmark::kMillisecond);

/// The least-squares problem that the estimate ends with, from nominal: all identifiable
/// parameters, noise and prior as found, no loss function.
struct LastProblem {
  const Experiment& experiment;
  CalibrationResult estimate;
  Prior prior;
  std::vector<PostureLoads> loads = {};  // nothing is elastic

  explicit LastProblem(const Experiment& e)
      : experiment(e),
        estimate(
            Calibrate(e.model, e.recording, e.base, ModelKind::kGeometric, e.project.calibration)),
        prior(e.project.calibration.prior.Scaled(estimate.prior_scale)) {}

  BodyResiduals Residuals() const {
    return {{estimate.model, experiment.recording, estimate.group, estimate.used, estimate.tied,
             loads, prior, estimate.noise},
            experiment.base.kept,
            Eigen::VectorXd::Zero(estimate.model.parameter_count()),
            estimate.placement};
  }
  Eigen::VectorXd Start() const {
    return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(experiment.base.kept.size()));
  }
};

/// The residual of one observation for Ceres to differentiate. Each call applies the errors to the
/// geometry and places the chain of the only marker for this one posture, by the same functions of
/// the library that the analytic problem uses; nothing else is computed.
class NumericObservation {
 public:
  NumericObservation(const LastProblem& problem, const BodyResiduals& shape, int posture)
      : model_(problem.estimate.model),
        shape_(shape),
        marker_sd_(problem.estimate.marker_sd),
        q_(problem.experiment.recording.q.row(posture).transpose()),
        p_measured_(MarkerPosition(problem.experiment.recording, posture, 0)),
        x_(problem.Start()) {}

  bool operator()(double const* const* blocks, double* residual) const {
    Eigen::Index at = 0;
    for (int size : shape_.parameter_blocks) {
      x_.segment(at, size) = Eigen::VectorXd::Map(*blocks++, size);
      at += size;
    }
    const Geometry geometry = ApplyErrors(model_, shape_.ToErrors(x_));
    Eigen::Map<Eigen::Vector3d> r(residual);
    r = (p_measured_ - MarkerPositions(model_, geometry, q_).col(0)) / marker_sd_;
    return true;
  }

 private:
  const ErrorModel& model_;
  const BodyResiduals& shape_;  // its blocks and scales
  double marker_sd_;
  Eigen::VectorXd q_;
  Eigen::Vector3d p_measured_;
  mutable Eigen::VectorXd x_;
};

/// The residual of a prior: the deviation of one unknown, the `entry`-th of its block.
struct NumericPrior {
  int entry;

  bool operator()(double const* const* blocks, double* residual) const {
    residual[0] = blocks[0][entry];
    return true;
  }
};

template <typename Functor>
ceres::CostFunction* NumericCost(Functor* functor, int residuals, const std::vector<int>& sizes) {
  auto* cost = new ceres::DynamicNumericDiffCostFunction<Functor, ceres::CENTRAL>(functor);
  for (int size : sizes) cost->AddParameterBlock(size);
  cost->SetNumResiduals(residuals);
  return cost;
}

/// Adds what BodyResiduals has, block for block.
void AddNumericResiduals(const LastProblem& problem, const BodyResiduals& shape,
                         const std::vector<double*>& blocks, ceres::Problem& ceres_problem) {
  const ObservationMask& used = problem.estimate.used;
  for (int i = 0; i < used.rows(); ++i) {
    if (!used(i, 0)) continue;
    ceres_problem.AddResidualBlock(
        NumericCost(new NumericObservation(problem, shape, i), 3, shape.parameter_blocks), nullptr,
        blocks);
  }
  int previous = -1;
  int entry = 0;
  for (const auto& prior : shape.residual_blocks) {
    if (prior.size != 1) continue;
    const int block = prior.parameter_blocks[0];
    entry = block == previous ? entry + 1 : 0;
    previous = block;
    ceres_problem.AddResidualBlock(
        NumericCost(new NumericPrior{entry}, 1, {shape.parameter_blocks[block]}), nullptr,
        blocks[block]);
  }
}

/// Same start, same linear solver and tolerances as elastocal::Solve has for a single marker.
ceres::Solver::Summary SolveNumerically(const LastProblem& problem) {
  const BodyResiduals shape = problem.Residuals();
  Eigen::VectorXd x = problem.Start();
  ceres::Problem ceres_problem;
  std::vector<double*> blocks;
  double* at = x.data();
  for (int size : shape.parameter_blocks) {
    blocks.push_back(at);
    at += size;
  }
  AddNumericResiduals(problem, shape, blocks, ceres_problem);

  const LeastSquaresOptions options;
  ceres::Solver::Options solver;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.function_tolerance;
  solver.parameter_tolerance = options.parameter_tolerance;
  solver.gradient_tolerance = 0.0;
  solver.initial_trust_region_radius = 1e8;
  solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &ceres_problem, &summary);
  return summary;
}

void SolveAgainstNumericDifferentiation(benchmark::State& state) {
  const Experiment experiment = OpenExperiment(state);
  const LastProblem problem(experiment);
  LeastSquaresResult analytic;
  ceres::Solver::Summary numeric;
  CompareInTurns(
      state, 1,
      [&] {
        BodyResiduals residuals = problem.Residuals();
        analytic = Solve(residuals, problem.Start(), {});
      },
      [&] { numeric = SolveNumerically(problem); });
  // The same minimum, or nothing was compared.
  if (std::abs(analytic.final_cost - numeric.final_cost) > 1e-6 * analytic.final_cost) {
    state.SkipWithError("the two solutions differ");
  }
  // Inexact derivatives also cost iterations; what one iteration costs is told apart.
  const double our_iterations = analytic.iterations;
  const double their_iterations = static_cast<double>(numeric.iterations.size()) - 1.0;
  state.counters["our_iterations"] = our_iterations;
  state.counters["their_iterations"] = their_iterations;
  state.counters["times_faster_by_iteration"] =
      state.counters["times_faster"] * our_iterations / their_iterations;
}
BENCHMARK(SolveAgainstNumericDifferentiation)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace elastocal
