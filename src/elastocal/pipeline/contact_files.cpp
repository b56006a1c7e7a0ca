// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <set>

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

/// "height_mm": a name with the unit in which it is shown.
std::string ShownName(const std::string& name, SourceUnit unit) {
  std::string suffix = ShownUnitOf(unit).name;
  for (std::size_t at; (at = suffix.find('/')) != std::string::npos;) {
    suffix.replace(at, 1, "_per_");
  }
  std::erase(suffix, '^');
  return suffix.empty() ? name : name + "_" + suffix;
}

Json SpreadJson(const ObservedRobot& model, const Spread& spread) {
  Json json = Json::object();
  for (std::size_t s = 0; s < model.setup.sources.size(); ++s) {
    const Source& source = model.setup.sources[s];
    if (source.role == Source::Role::kFixed) continue;
    json[ShownName(source.name, source.unit)] = ShownUnitOf(source.unit).factor * spread.sd[s];
  }
  return json;
}

/// How many numbers told each standard deviation of the spread.
Json SpreadNumbersJson(const ObservedRobot& model, const ObservationFit& fit) {
  Json json = Json::object();
  for (std::size_t s = 0; s < fit.spread_freedom.size(); ++s) {
    const Source& source = model.setup.sources[s];
    if (source.role != Source::Role::kFixed) json[source.name] = fit.spread_freedom[s];
  }
  return json;
}

Json PlatesJson(const ContactRun& run) {
  Json json = Json::array();
  const ObservedValues& values = run.calibrated.estimate.fit.values;
  for (std::size_t p = 0; p < run.model.setup.plates.size(); ++p) {
    if (run.calibrated.in_sample.by_plate[p].touches == 0) continue;
    const std::vector<int>& of = run.model.setup.instruments[p]->quantities;
    const Eigen::VectorXd& tilts = values.quantities[of[0]].x;
    const QuantityValue& table = values.quantities[of[1]];
    json.push_back({{"name", run.model.setup.plates[p].name},
                    {"touches", run.calibrated.in_sample.by_plate[p].touches},
                    {"tilts_deg", {kDegreesOf * tilts[0], kDegreesOf * tilts[1]}},
                    {"table_height_mm", 1e3 * (table.origin.translation().z() + table.x[0])},
                    {"table_tilts_deg", {kDegreesOf * table.x[1], kDegreesOf * table.x[2]}}});
  }
  return json;
}

/// Quantities that instruments other than plates depend on: origin, values and their standard
/// deviations, SI.
Json QuantitiesJson(const ContactRun& run) {
  Json json = Json::array();
  const ObservationFit& fit = run.calibrated.estimate.fit;
  std::set<int> shown;
  for (std::size_t n = run.model.setup.plates.size(); n < run.model.setup.instruments.size(); ++n) {
    for (int index : run.model.setup.instruments[n]->quantities) {
      if (!shown.insert(index).second) continue;
      const QuantityValue& value = fit.values.quantities[index];
      const Eigen::Vector3d rpy = ToRpy(value.origin.linear(), Eigen::Vector3d::Zero());
      Json values = Json::array();
      Json sds = Json::array();
      for (Eigen::Index k = 0; k < value.x.size(); ++k) {
        const Eigen::Index entry = fit.entry_of_quantity[index] + k;
        values.push_back(value.x[k]);
        sds.push_back(std::sqrt(fit.covariance(entry, entry)));
      }
      const Eigen::Vector3d& p = value.origin.translation();
      json.push_back({{"name", run.model.setup.quantities[index].name},
                      {"origin_xyz_m", {p.x(), p.y(), p.z()}},
                      {"origin_rpy_rad", {rpy.x(), rpy.y(), rpy.z()}},
                      {"values", values},
                      {"sds", sds}});
    }
  }
  return json;
}

/// What is left of an observation: of touches as height_mm and tilt_deg, of others by rows.
void AddLeft(const Instrument& instrument, const Eigen::VectorXd& left, Json& json) {
  if (instrument.measured_size() == 0) {
    json["height_mm"] = 1e3 * left[0];
    json["tilt_deg"] = {kDegreesOf * left[1], kDegreesOf * left[2]};
    return;
  }
  const std::vector<RowMeaning> rows = instrument.rows();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    json[ShownName(rows[i].name, rows[i].unit)].push_back(ShownUnitOf(rows[i].unit).factor *
                                                          left[static_cast<Eigen::Index>(i)]);
  }
}

Json PlaceOf(const ContactRun& run, int index) {
  const Observation& observation = run.observations.all[index];
  const PosturePlace& place = run.observations.postures[observation.posture];
  const std::string& name = run.model.instrument(observation.instrument).name;
  return {{"file", run.observations.files[place.file]},
          {"line", place.line},
          {run.model.IsPlate(observation.instrument) ? "plate" : "instrument", name}};
}

Json OutlierList(const ContactRun& run) {
  Json json = Json::array();
  for (const ObservationOutlier& outlier : run.calibrated.estimate.outliers) {
    const Observation& observation = run.observations.all[outlier.observation];
    json.push_back(PlaceOf(run, outlier.observation));
    AddLeft(run.model.instrument(observation.instrument), outlier.left, json.back());
  }
  return json;
}

Json ObservationList(const ContactRun& run, bool plates) {
  Json json = Json::array();
  const ObservationCrossValidation& folds = run.calibrated.held_out;
  for (int i = 0; folds.folds > 0 && i < run.observations.count(); ++i) {
    const Observation& observation = run.observations.all[i];
    if (run.model.IsPlate(observation.instrument) != plates) continue;
    json.push_back(PlaceOf(run, i));
    if (!observation.effects.empty()) {
      json.back()["session"] = run.observations.effects[observation.effects.front()].name;
    }
    AddLeft(run.model.instrument(observation.instrument), folds.left[i], json.back());
  }
  return json;
}

Json ContactJson(const ContactRun& run) {
  const ObservationFit& fit = run.calibrated.estimate.fit;
  Json json;
  json["touches"] = run.calibrated.in_sample.all.touches;
  json["observations"] = run.observations.count();
  json["sessions"] = run.observations.effects.size();
  json["fit"] = FiguresJson(run.model, run.calibrated.in_sample);
  json["fit"]["uncalibrated"] = FiguresJson(run.model, run.uncalibrated.in_sample);
  if (run.calibrated.held_out.folds > 0) {
    json["kfold"] = FiguresJson(run.model, run.calibrated.held_out.figures);
    json["kfold"]["folds"] = run.calibrated.held_out.folds;
    json["kfold"]["uncalibrated"] = FiguresJson(run.model, run.uncalibrated.held_out.figures);
    json["kfold"]["of_touches"] = ObservationList(run, true);
    if (!run.touches_only()) json["kfold"]["of_others"] = ObservationList(run, false);
  }
  if (run.geometric) {
    json["urdf_alone"] = FiguresJson(run.model, ContactRun::Judged(*run.geometric));
  }
  json["gain_in_sds"] = run.gain_in_sds;
  json["plates"] = PlatesJson(run);
  if (!run.touches_only()) json["quantities"] = QuantitiesJson(run);
  json["spread"] = SpreadJson(run.model, fit.spread);
  json["spread_numbers"] = SpreadNumbersJson(run.model, fit);
  json["closure"] = {{"exact", run.closure.exact},
                     {"postures", run.closure.postures},
                     {"median_mm", 1e3 * run.closure.median},
                     {"refused", run.closure.planned()}};
  json["outliers"] = OutlierList(run);
  return json;
}

}  // namespace

ShownUnit ShownUnitOf(SourceUnit unit) {
  switch (unit) {
    case SourceUnit::kMetre:
      return {"mm", 1e3};
    case SourceUnit::kRadian:
      return {"deg", kDegreesOf};
    case SourceUnit::kAcceleration:
      return {"m/s^2", 1.0};
    case SourceUnit::kPixel:
      return {"px", 1.0};
    default:
      return {"", 1.0};
  }
}

nlohmann::ordered_json FiguresJson(const ObservedRobot& model, const ObservationFigures& figures) {
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
  for (const RowErrors& of : figures.rows) {
    if (model.IsPlate(of.instrument)) continue;
    Json& list = json["instruments"];
    const Instrument& instrument = model.instrument(of.instrument);
    if (list.empty() || list.back()["name"] != instrument.name) {
      list.push_back({{"name", instrument.name},
                      {"kind", instrument.kind()},
                      {"observations", of.observations}});
    }
    list.back()[ShownName(of.row, of.unit)] = ShownUnitOf(of.unit).factor * of.rms;
  }
  return json;
}

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
