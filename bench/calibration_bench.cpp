// The calibration of examples/talos_left_arm: how long the estimate takes, and how much of that the
// analytic Jacobian saves against Ceres' own numeric differentiation of the same problem.
#include <memory>
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
  experiment.recording = real ? ReadPostureTable(file, project).recording
                              : GenerateRecording(experiment.model, experiment.base,
                                                  project.calibration.prior);
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
      result = Calibrate(e.model, e.recording, e.base, ModelKind::kGeometric,
                         e.project.calibration);
    }));
  }
  state.counters["median"] = MedianOf(seconds);
  state.counters["iterations"] = result.iterations;
}
BENCHMARK(EstimateGeometric)->Unit(benchmark::kMillisecond);

/// The least-squares problem that the estimate ends with, from its start: all identifiable
/// parameters, noise and prior as found, no loss function.
struct LastProblem {
  const Experiment& experiment;
  CalibrationResult estimate;

  MarkerResiduals Residuals() const {
    return {estimate.model,
            experiment.recording,
            estimate.used,
            experiment.base.kept,
            Eigen::VectorXd::Zero(estimate.model.parameter_count()),
            experiment.project.calibration.prior.Scaled(estimate.prior_scale),
            estimate.marker_sd};
  }
};

/// The residual of one observation for Ceres to differentiate: it applies the errors and places the
/// chain of the only marker, by the library's own functions and for this one posture only.
class NumericObservation {
 public:
  NumericObservation(const LastProblem& problem, const MarkerResiduals& residuals, int posture)
      : model_(problem.estimate.model),
        residuals_(residuals),
        marker_sd_(problem.estimate.marker_sd),
        q_(problem.experiment.recording.q.row(posture).transpose()),
        p_measured_(MarkerPosition(problem.experiment.recording, posture, 0)),
        x_(static_cast<Eigen::Index>(problem.experiment.base.kept.size())) {}

  bool operator()(double const* const* blocks, double* residual) const {
    Eigen::Index at = 0;
    for (int size : residuals_.parameter_blocks) {
      x_.segment(at, size) = Eigen::VectorXd::Map(*blocks++, size);
      at += size;
    }
    const Geometry geometry = ApplyErrors(model_, residuals_.ToErrors(x_));
    Eigen::Map<Eigen::Vector3d>(residual) =
        (p_measured_ - MarkerPositions(model_, geometry, q_).col(0)) / marker_sd_;
    return true;
  }

 private:
  const ErrorModel& model_;
  const MarkerResiduals& residuals_;  // for its blocks and scales only
  double marker_sd_;
  Eigen::VectorXd q_;
  Eigen::Vector3d p_measured_;
  mutable Eigen::VectorXd x_;
};

template <typename Functor>
ceres::CostFunction* NumericCost(Functor* functor, int residuals, const std::vector<int>& sizes) {
  auto* cost = new ceres::DynamicNumericDiffCostFunction<Functor, ceres::CENTRAL>(functor);
  for (int size : sizes) cost->AddParameterBlock(size);
  cost->SetNumResiduals(residuals);
  return cost;
}

/// Deviations of one block of unknowns from nominal, in standard deviations of the prior.
ceres::CostFunction* PriorCost(int size) {
  return new ceres::NormalPrior(Eigen::MatrixXd::Identity(size, size), Eigen::VectorXd::Zero(size));
}

/// The same problem as the analytic one, block for block, with the options of elastocal::Solve.
ceres::Solver::Summary SolveNumerically(const LastProblem& problem) {
  const MarkerResiduals shape = problem.Residuals();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(
      problem.experiment.base.kept.size()));
  ceres::Problem ceres_problem;
  std::vector<double*> blocks;
  double* at = x.data();
  for (int size : shape.parameter_blocks) {
    blocks.push_back(at);
    ceres_problem.AddParameterBlock(at, size);
    at += size;
  }
  const Recording& recording = problem.experiment.recording;
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (!problem.estimate.used(i, 0)) continue;
    ceres_problem.AddResidualBlock(
        NumericCost(new NumericObservation(problem, shape, i), 3, shape.parameter_blocks), nullptr,
        blocks);
  }
  for (const auto& block : shape.residual_blocks) {
    if (block.size == 3) continue;
  }

  const LeastSquaresOptions options;
  ceres::Solver::Options solver;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.function_tolerance;
  solver.parameter_tolerance = options.parameter_tolerance;
  solver.gradient_tolerance = 0.0;
  solver.logging_type = ceres::SILENT;
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (double* block : blocks) solver.linear_solver_ordering->AddElementToGroup(block, 1);
  for (int k : shape.eliminated_blocks) {
    solver.linear_solver_ordering->AddElementToGroup(blocks[k], 0);
  }
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &ceres_problem, &summary);
  return summary;
}
}  // namespace
}  // namespace elastocal
