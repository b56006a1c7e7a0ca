// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <nlohmann/json.hpp>

#include "elastocal/io/calibration_file.hpp"
#include "elastocal/io/contact_file.hpp"
#include "elastocal/io/covariance_file.hpp"
#include "elastocal/pipeline/cause_picture_json.hpp"
#include "elastocal/pipeline/contact_json.hpp"
#include "elastocal/pipeline/contact_run.hpp"
#include "elastocal/pipeline/diagnose.hpp"
#include "elastocal/pipeline/robot_views.hpp"
#include "elastocal/tables/json_text.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

Json NumberOrNull(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json ParameterList(const CalibrationResult& result) {
  Json json = Json::array();
  for (int i = 0; i < result.model.parameter_count(); ++i) {
    const Parameter& parameter = result.model.parameters[i];
    json.push_back({{"name", parameter.name},
                    {"unit", UnitName(parameter.unit)},
                    {"value", result.delta[i]},
                    {"sd", NumberOrNull(result.sd[i])},
                    {"status", StatusName(result.status[i])},
                    {"significant", Significant(result, i)}});
  }
  return json;
}

}  // namespace

std::string RunStatus(const ContactRun& run) {
  if (run.deployable()) return "converged";
  return run.calibrated.estimate.fit.settled ? "implausible" : "not converged";
}

std::string MakeContactSummary(const ContactRun& run) {
  Json json;
  json["status"] = RunStatus(run);
  json["settled"] = run.calibrated.estimate.fit.settled;
  json["objections"] = run.verdict.objections;
  json["remarks"] = run.verdict.remarks;
  json["robot"] = run.model.robot.tree.name;
  json["recording"] = run.recording;
  json["postures"] = run.observations.posture_count();
  json["parameters_total"] = run.result.model.parameter_count();
  json["equations"] = run.result.equations;
  json["effective_parameters"] = run.result.posterior.effective_parameters;
  json["model"] = ModelKindName(run.result.kind);
  json["contact"] = ContactJson(run);
  json["parameters"] = ParameterList(run.result);
  if (!run.extra.empty()) json["extra"] = run.extra;
  if (run.causes) {
    json["diagnosis"] = DescribeDiagnosis(*run.causes);
    json["diagnosis_pictures"] = CausePicturesJson(*run.causes);
  }
  json["iterations"] = run.result.iterations;
  json["warnings"] = run.warnings;
  return JsonText(json);
}

std::map<std::string, std::string> MakeContactFiles(const Project& project, ContactRun& run) {
  std::map<std::string, std::string> files;
  if (run.urdf) {
    files[project.urdf.stem().string() + "_calibrated.urdf"] = run.urdf->text;
    files["calibration.yaml"] =
        MakeCalibrationYaml(run.result, run.recording, run.zero_offsets,
                            {.in_urdf = run.in_urdf ? &*run.in_urdf : nullptr}) +
        MakeContactYaml(run.model, run.calibrated.estimate.fit, run.uncalibrated.estimate.fit);
    files["offsets.xacro"] = MakeXacroOffsets(*run.urdf);
    files["covariance.csv"] = MakeCovarianceCsv(run.result);
  }
  files["report_data.json"] = MakeRobotDataJson(MakeRobotView(project, run.warnings));
  files["summary.json"] = MakeContactSummary(run);
  return files;
}

}  // namespace elastocal
