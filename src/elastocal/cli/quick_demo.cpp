#include "elastocal/cli/quick_demo.hpp"

#include <cmath>
#include <filesystem>
#include <set>

#include <fmt/format.h>

#include "elastocal/cli/calibration_run.hpp"
#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/io/output_files.hpp"
#include "elastocal/io/posture_table.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"

namespace elastocal::cli {
namespace {

/// Markers of the whole upper body: on all links that no leg carries.
std::vector<std::string> UpperBodyMarkers(const Project& project) {
  std::set<std::string> legs;
  for (const Chain& chain : project.chains) {
    if (!chain.name.starts_with("leg")) continue;
    for (const std::string& name : ChainMarkers(project, chain)) legs.insert(name);
  }
  std::vector<std::string> names;
  for (const Marker& marker : project.markers) {
    if (!legs.contains(marker.name)) names.push_back(marker.name);
  }
  return names;
}

/// A robot with errors of the size of the paper's Table 1, seen from a camera frame a few metres
/// away, its markers a few millimetres from where they were meant to be.
struct Truth {
  ErrorModel model;
  Eigen::VectorXd delta;
};

Truth DrawTruth(const Project& project, std::uint64_t seed) {
  constexpr double kDegree = M_PI / 180.0;
  Truth truth;
  truth.model = SelectMarkers(MakeErrorModel(project.tree, project.markers, project.placement),
                              UpperBodyMarkers(project));
  truth.model.T_ref_waist = Transform(Eigen::Translation3d(1.2, -0.8, 1.0)) * RotZ(2.0);
  using Kind = ParameterKind;
  truth.delta =
      DrawErrors(truth.model, FindBaseParameters(truth.model, project.identifiability).kept,
                 {{Kind::kTheta, 1.0 * kDegree},
                  {Kind::kR, 1e-3},
                  {Kind::kD, 1e-3},
                  {Kind::kB, 1e-3},
                  {Kind::kAlpha, 0.3 * kDegree},
                  {Kind::kBeta, 0.3 * kDegree},
                  {Kind::kGamma, 0.3 * kDegree},
                  {Kind::kMarker, 5e-3}},
                 seed);
  return truth;
}

std::string TruthTable(const Truth& truth, const CalibrationResult& result) {
  TextTable table({"parameter", "unit", "truth", "estimate", "sd", "error / sd"});
  int inside = 0;
  int count = 0;
  for (int i = 0; i < result.model.parameter_count(); ++i) {
    const Parameter& parameter = result.model.parameters[i];
    if (parameter.joint < 0 || result.status[i] != ParameterStatus::kEstimated) continue;
    const double true_value = truth.delta[FindParameter(truth.model.parameters, parameter.name)];
    const double error = result.delta[i] - true_value;
    inside += std::abs(error) <= result.interval_factor * result.sd[i] ? 1 : 0;
    ++count;
    table.Add({parameter.name, UserUnit(parameter),
               fmt::format("{:.4f}", InUserUnits(parameter, true_value)),
               fmt::format("{:.4f}", InUserUnits(parameter, result.delta[i])),
               fmt::format("{:.4f}", InUserUnits(parameter, result.sd[i])),
               fmt::format("{:+.2f}", error / result.sd[i])});
  }
  return "\nTruth against estimate\n" + table.Render() +
         fmt::format("  {} of {} joint parameters lie within their 95 % interval\n", inside, count);
}

}  // namespace

int QuickDemo(const QuickDemoOptions& options) {
  const std::filesystem::path& source = options.project;
  const std::filesystem::path& folder = options.output;
  const Project project = ReadProject(source);
  const std::uint64_t seed = options.common.seed.value_or(1);
  const Truth truth = DrawTruth(project, seed);
  const Recording recording = MakeSyntheticRecording(
      truth.model, truth.delta, {.postures = options.postures, .seed = seed + 1});
  WritePostureTable(folder / "recording.csv", recording, project.tree);
  Print(
      options.common.Silent(),
      fmt::format("A TALOS with known errors, {} random postures of its upper body, 0.2 mm marker "
                  "noise: {}\n\n",
                  options.postures, (folder / "recording.csv").string()));

  CalibrateOptions calibrate{
      options.common, source.string(), folder.string(), {(folder / "recording.csv").string()}, 5,
      "origin"};
  CalibrationRun run;
  const int exit_code = RunCalibration(calibrate, &run);
  Print(options.common.Silent(), TruthTable(truth, run.comparison.largest()));
  return exit_code;
}

}  // namespace elastocal::cli
