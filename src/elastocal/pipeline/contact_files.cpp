#include <cmath>

#include <nlohmann/json.hpp>

#include "elastocal/io/calibration_file.hpp"
#include "elastocal/io/contact_file.hpp"
#include "elastocal/io/covariance_file.hpp"
#include "elastocal/pipeline/contact_json.hpp"
#include "elastocal/pipeline/contact_run.hpp"
#include "elastocal/pipeline/robot_views.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegreesOf = 180.0 / M_PI;

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

Json SpreadJson(const ContactSpread& spread) {
  Json json;
  for (int s = 0; s < kContactSourceCount; ++s) {
    const auto source = static_cast<ContactSource>(s);
    const std::string name = ContactSourceName(source);
    if (IsAngular(source)) {
      json[name + "_deg"] = kDegreesOf * spread[source];
    } else if (source == ContactSource::kTorsion || source == ContactSource::kBending) {
      json[name] = spread[source];
    } else {
      json[name + "_mm"] = 1e3 * spread[source];
    }
  }
  return json;
}

Json PlatesJson(const ContactRun& run) {
  Json json = Json::array();
  const ContactValues& values = run.calibrated.estimate.fit.values;
  for (std::size_t p = 0; p < run.model.setup.plates.size(); ++p) {
    if (run.calibrated.in_sample.by_plate[p].touches == 0) continue;
    const Eigen::Vector3d& plane = values.tables[p].height_tilts;
    json.push_back(
        {{"name", run.model.setup.plates[p].name},
         {"touches", run.calibrated.in_sample.by_plate[p].touches},
         {"tilts_deg",
          {kDegreesOf * values.plate_tilts[p][0], kDegreesOf * values.plate_tilts[p][1]}},
         {"table_height_mm", 1e3 * (values.tables[p].pivot.z() + plane[0])},
         {"table_tilts_deg", {kDegreesOf * plane[1], kDegreesOf * plane[2]}}});
  }
  return json;
}

Json OutlierList(const ContactRun& run) {
  Json json = Json::array();
  for (const TouchOutlier& outlier : run.calibrated.estimate.outliers) {
    const Touch& touch = run.touches.touches[outlier.touch];
    json.push_back({{"file", run.touches.files[touch.file]},
                    {"line", touch.line},
                    {"height_mm", 1e3 * outlier.left[0]},
                    {"tilt_deg", {kDegreesOf * outlier.left[1], kDegreesOf * outlier.left[2]}}});
  }
  return json;
}

Json TouchList(const ContactRun& run) {
  Json json = Json::array();
  const TouchCrossValidation& folds = run.calibrated.held_out;
  for (int i = 0; folds.folds > 0 && i < run.touches.count(); ++i) {
    const Touch& touch = run.touches.touches[i];
    json.push_back({{"file", run.touches.files[touch.file]},
                    {"line", touch.line},
                    {"plate", run.model.setup.plates[touch.plate].name},
                    {"session", run.touches.sessions[touch.session].name},
                    {"height_mm", 1e3 * folds.left(i, 0)},
                    {"tilt_deg", {kDegreesOf * folds.left(i, 1), kDegreesOf * folds.left(i, 2)}}});
  }
  return json;
}

Json ContactJson(const ContactRun& run) {
  const ContactFit& fit = run.calibrated.estimate.fit;
  Json json;
  json["touches"] = run.touches.count();
  json["sessions"] = run.touches.sessions.size();
  json["fit"] = FiguresJson(run.model, run.calibrated.in_sample);
  json["fit"]["uncalibrated"] = FiguresJson(run.model, run.uncalibrated.in_sample);
  if (run.calibrated.held_out.folds > 0) {
    json["kfold"] = FiguresJson(run.model, run.calibrated.held_out.figures);
    json["kfold"]["folds"] = run.calibrated.held_out.folds;
    json["kfold"]["uncalibrated"] = FiguresJson(run.model, run.uncalibrated.held_out.figures);
    json["kfold"]["of_touches"] = TouchList(run);
  }
  if (run.geometric) {
    json["urdf_alone"] = FiguresJson(run.model, ContactRun::Judged(*run.geometric));
  }
  json["gain_in_sds"] = run.gain_in_sds;
  json["plates"] = PlatesJson(run);
  json["spread"] = SpreadJson(fit.spread);
  json["closure"] = {{"exact", run.closure.exact},
                     {"postures", run.closure.postures},
                     {"median_mm", 1e3 * run.closure.median},
                     {"refused", run.closure.planned()}};
  json["outliers"] = OutlierList(run);
  return json;
}

}  // namespace

nlohmann::ordered_json FiguresJson(const ContactModel& model, const TouchFigures& figures) {
  const auto errors = [](const TouchErrors& of) {
    return Json{{"touches", of.touches},
                {"height_mm", 1e3 * of.height},
                {"tilt_deg", kDegreesOf * of.tilt()},
                {"tilt_x_deg", kDegreesOf * of.tilt_x},
                {"tilt_y_deg", kDegreesOf * of.tilt_y},
                {"max_height_mm", 1e3 * of.largest_height}};
  };
  Json json = errors(figures.all);
  json["by_side"] = Json::object();
  for (std::size_t p = 0; p < figures.by_plate.size(); ++p) {
    if (figures.by_plate[p].touches == 0) continue;
    json["by_side"][model.setup.plates[p].name] = errors(figures.by_plate[p]);
  }
  return json;
}

std::string MakeContactSummary(const ContactRun& run) {
  Json json;
  json["status"] = run.deployable()                      ? "converged"
                   : run.calibrated.estimate.fit.settled ? "implausible"
                                                         : "not converged";
  json["settled"] = run.calibrated.estimate.fit.settled;
  json["objections"] = run.verdict.objections;
  json["remarks"] = run.verdict.remarks;
  json["robot"] = run.model.robot.tree.name;
  json["recording"] = run.recording;
  json["postures"] = run.touches.count();
  json["parameters_total"] = run.result.model.parameter_count();
  json["equations"] = run.result.equations;
  json["effective_parameters"] = run.result.posterior.effective_parameters;
  json["model"] = ModelKindName(run.result.kind);
  json["contact"] = ContactJson(run);
  json["parameters"] = ParameterList(run.result);
  json["iterations"] = run.result.iterations;
  json["warnings"] = run.warnings;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::map<std::string, std::string> MakeContactFiles(const Project& project, ContactRun& run) {
  std::map<std::string, std::string> files;
  if (run.urdf) {
    files[project.urdf.stem().string() + "_calibrated.urdf"] = run.urdf->text;
    files["calibration.yaml"] =
        MakeCalibrationYaml(run.result, run.recording, run.zero_offsets) +
        MakeContactYaml(run.model, run.calibrated.estimate.fit, run.uncalibrated.estimate.fit);
    files["offsets.xacro"] = MakeXacroOffsets(*run.urdf);
    files["covariance.csv"] = MakeCovarianceCsv(run.result);
  }
  files["report_data.json"] = MakeRobotDataJson(MakeRobotView(project, run.warnings));
  files["summary.json"] = MakeContactSummary(run);
  return files;
}

}  // namespace elastocal
