// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/contact_commands.hpp"

#include <cmath>

#include <fmt/format.h>

#include "elastocal/cli/figures.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/pipeline/contact_json.hpp"
#include "elastocal/pipeline/contact_run.hpp"
#include "elastocal/pipeline/contact_validation.hpp"
#include "elastocal/robot/parameter_names.hpp"

namespace elastocal::cli {
namespace {

constexpr double kToDegrees = 180.0 / M_PI;
constexpr double kPerHundredNm = 100.0 * kToDegrees;  // rad/(N.m) to degrees per 100 N.m

void AddFigures(const std::string& name, const ObservedRobot& model,
                const ObservationFigures& figures, TextTable& table) {
  if (figures.all.touches == 0) return;
  const auto add = [&](const std::string& of, const TouchErrors& errors) {
    table.Add({name + of, std::to_string(errors.touches),
               fmt::format("{:.2f}", 1e3 * errors.height),
               fmt::format("{:.3f}", kToDegrees * errors.tilt_x),
               fmt::format("{:.3f}", kToDegrees * errors.tilt_y),
               fmt::format("{:.2f}", 1e3 * errors.largest_height)});
  };
  add("", figures.all);
  for (std::size_t p = 0; p < figures.by_plate.size(); ++p) {
    if (figures.by_plate[p].touches == 0) continue;
    if (figures.by_plate[p].touches == figures.all.touches) continue;
    add("  " + model.setup.plates[p].name, figures.by_plate[p]);
  }
}

const std::vector<std::string> kFigureHeader = {"touches",    "number",     "height mm",
                                                "tilt x deg", "tilt y deg", "max height mm"};

/// Text with the root mean square errors of all instruments but plates; empty where there are none.
std::string InstrumentText(const ObservedRobot& model, const ObservationFigures& uncalibrated,
                           const ObservationFigures& calibrated) {
  TextTable table({"instrument", "number", "rms of a coordinate", "uncalibrated", "calibrated"});
  bool any = false;
  for (std::size_t i = 0; i < calibrated.rows.size(); ++i) {
    const RowErrors& after = calibrated.rows[i];
    if (model.IsPlate(after.instrument)) continue;
    any = true;
    const ShownUnit unit = ShownUnitOf(after.unit);
    table.Add({model.instrument(after.instrument).name, std::to_string(after.observations),
               after.row + " " + unit.name,
               fmt::format("{:.4g}", unit.factor * uncalibrated.rows[i].rms),
               fmt::format("{:.4g}", unit.factor * after.rms)});
  }
  return any ? table.Render() : "";
}

std::string ComplianceText(const CalibrationResult& result) {
  std::string text;
  for (int i = 0; i < result.model.parameter_count(); ++i) {
    const Parameter& parameter = result.model.parameters[i];
    if (!IsCompliance(parameter.kind) || !std::isfinite(result.sd[i])) continue;
    if (parameter.unit != ParameterUnit::kRadianPerNewtonMetre) continue;
    const double sd = kPerHundredNm * result.sd[i];
    text += fmt::format("  {} {} +- {} degrees per 100 N.m ({})\n", parameter.name,
                        RoundedTo(kPerHundredNm * result.delta[i], sd), RoundedSd(sd),
                        StatusName(result.status[i]));
  }
  return text;
}

/// Text on joint offsets that differ from zero: rotations, or translations of prismatic joints.
std::string OffsetText(const CalibrationResult& result) {
  std::string text;
  for (int i = 0; i < result.model.parameter_count(); ++i) {
    const Parameter& parameter = result.model.parameters[i];
    if (parameter.joint < 0 || !std::isfinite(result.sd[i])) continue;
    const JointType type = result.model.tree.joints[static_cast<std::size_t>(parameter.joint)].type;
    const bool slides = type == JointType::kPrismatic;
    if (parameter.kind != (slides ? ParameterKind::kR : ParameterKind::kTheta)) continue;
    if (!Significant(result, i)) continue;
    const double sd = InUserUnits(parameter, result.sd[i]);
    text += fmt::format("  {} {} +- {} {}\n", parameter.name,
                        RoundedTo(InUserUnits(parameter, result.delta[i]), sd), RoundedSd(sd),
                        slides ? "mm" : "degrees");
  }
  return text.empty() ? "  none\n" : text;
}

/// Text on causes beyond geometry and springs in the model, with their estimates.
std::string CausesText(const ContactRun& run) {
  std::string text = "Beyond geometry and springs\n";
  for (int i = 0; i < run.result.model.parameter_count(); ++i) {
    const Parameter& parameter = run.result.model.parameters[i];
    if (parameter.kind != ParameterKind::kCorrection) continue;
    const double sd = InUserUnits(parameter, run.result.sd[i]);
    text += fmt::format("  {} {} +- {} {} ({})\n", parameter.name,
                        RoundedTo(InUserUnits(parameter, run.result.delta[i]), sd), RoundedSd(sd),
                        UserUnit(parameter), StatusName(run.result.status[i]));
  }
  return text;
}

std::string DescribeContactRun(const ContactRun& run) {
  const bool folded = run.calibrated.held_out.folds > 0;
  const TouchErrors& before = ContactRun::Judged(run.uncalibrated).all;
  const TouchErrors& after = ContactRun::Judged(run.calibrated).all;
  std::string text;
  if (!run.deployable()) {
    text = "Verdict: do not deploy. " + run.verdict.objections.front() + "\n";
  } else if (after.touches == 0) {
    text = folded ? "Verdict: better on postures that were left out. Before deploying, validate on "
                    "another day.\n"
                  : "Verdict: better in the fit. Before deploying, cross-validate (--kfold) and "
                    "validate.\n";
  } else {
    text = fmt::format(
        "Verdict: height of touches from {:.2f} to {:.2f} mm, tilt from {:.2f} to {:.2f} degrees\n"
        "  {}\n",
        1e3 * before.height, 1e3 * after.height, kToDegrees * before.tilt(),
        kToDegrees * after.tilt(),
        folded ? "On touches that were left out. Before deploying, validate on another day."
               : "In the fit. Before deploying, cross-validate (--kfold) and validate.");
  }
  text += fmt::format("{}: {} observations in {} postures, {:.0f} numbers determined by them\n\n",
                      run.model.robot.tree.name, run.observations.count(),
                      run.observations.posture_count(), run.result.posterior.effective_parameters);
  std::vector<std::string> header = kFigureHeader;
  header.front() = folded ? fmt::format("left out, {} folds", run.calibrated.held_out.folds)
                          : std::string("in the fit");
  TextTable table(header);
  AddFigures("uncalibrated", run.model, ContactRun::Judged(run.uncalibrated), table);
  if (run.geometric) {
    AddFigures("URDF alone", run.model, ContactRun::Judged(*run.geometric), table);
  }
  AddFigures("calibrated", run.model, ContactRun::Judged(run.calibrated), table);
  if (after.touches > 0) text += table.Render();
  text += InstrumentText(run.model, ContactRun::Judged(run.uncalibrated),
                         ContactRun::Judged(run.calibrated));
  const std::string compliance = ComplianceText(run.result);
  if (!compliance.empty()) text += "\nCompliance\n" + compliance;
  if (!run.extra.empty()) text += "\n" + CausesText(run);
  text += "\nJoint offsets that are not zero\n" + OffsetText(run.result) + "\n";
  for (const std::string& remark : run.verdict.remarks) text += "Remark: " + remark + "\n";
  return text;
}

}  // namespace

CommandResult CalibrateByContacts(const CalibrateOptions& options, const Project& project,
                                  const std::vector<std::filesystem::path>& recordings) {
  const auto progress = TerminalSteps("reading and fitting", options.common.quiet);
  Progress of_folds;
  if (progress) {
    of_folds = [&](int done, int total) { progress("cross-validation", done, total); };
  }
  ContactRun run =
      CalibrateContacts(project, recordings,
                        {.folds = options.folds,
                         .threads = options.threads,
                         .zero_offsets = options.zero_offsets == "encoder" ? ZeroOffsets::kEncoder
                                                                           : ZeroOffsets::kOrigin,
                         .accept = options.accept,
                         .prior = options.prior,
                         .days = options.days,
                         .progress = of_folds});
  return {.files = MakeContactFiles(project, run),
          .json = {},
          .text = DescribeContactRun(run),
          .warnings = run.warnings,
          .errors = run.verdict.objections,
          .fine = run.deployable()};
}

CommandResult ValidateByContacts(const Project& project, const std::filesystem::path& calibration,
                                 const std::vector<std::filesystem::path>& recordings,
                                 bool refit_table, const std::vector<std::string>& accept) {
  const ContactValidation run =
      ValidateContacts(project, calibration, recordings, refit_table, accept);
  std::vector<std::string> header = kFigureHeader;
  header.front() = run.surroundings_refitted ? "table registered anew" : "table as it was";
  TextTable table(header);
  AddFigures("uncalibrated", run.model, run.uncalibrated, table);
  AddFigures("calibrated", run.model, run.calibrated, table);
  CommandResult result;
  result.json = MakeContactValidationJson(run);
  result.text =
      fmt::format("{}, {} postures\n\n", run.recording, run.observations.posture_count()) +
      (run.calibrated.all.touches > 0 ? table.Render() : "") +
      InstrumentText(run.model, run.uncalibrated, run.calibrated);
  result.warnings = run.warnings;
  for (const std::string& objection : run.objections) {
    result.errors.push_back(objection + ": do not deploy");
  }
  result.fine = run.better();
  return result;
}

}  // namespace elastocal::cli
