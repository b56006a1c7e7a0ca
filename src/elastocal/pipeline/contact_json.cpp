// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/contact_json.hpp"

#include <cmath>
#include <set>

#include <nlohmann/json.hpp>

#include "elastocal/pipeline/contact_run.hpp"
#include "elastocal/pipeline/contact_verdict.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegreesOf = 180.0 / M_PI;

/// A name with the unit in which it is shown: "height_mm".
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

/// Number of numbers from which each standard deviation of the spread was estimated.
Json SpreadNumbersJson(const ObservedRobot& model, const ObservationFit& fit) {
  Json json = Json::object();
  for (std::size_t s = 0; s < fit.spread_freedom.size(); ++s) {
    const Source& source = model.setup.sources[s];
    if (source.role != Source::Role::kFixed) json[source.name] = fit.spread_freedom[s];
  }
  return json;
}

/// Standard deviations of the numbers of a quantity or of a session's effect, times `factor`,
/// starting at an entry of the covariance; null where they were not estimated.
Json SdsJson(const ObservationFit& fit, int entry, int first, int count, double factor) {
  Json sds = Json::array();
  for (int k = first; k < first + count; ++k) {
    sds.push_back(entry < 0 ? Json(nullptr)
                            : Json(factor * std::sqrt(fit.covariance(entry + k, entry + k))));
  }
  return sds;
}

Json NumbersJson(const Eigen::VectorXd& x, int first, int count, double factor) {
  Json numbers = Json::array();
  for (int k = first; k < first + count; ++k) numbers.push_back(factor * x[k]);
  return numbers;
}

/// SI units of the numbers of a quantity; empty for a relative number.
Json UnitsJson(const ObservationSetup& setup, int quantity) {
  Json units = Json::array();
  for (int source : setup.quantities[quantity].sources) {
    const SourceUnit unit = setup.sources[source].unit;
    units.push_back(unit == SourceUnit::kMetre    ? "m"
                    : unit == SourceUnit::kRadian ? "rad"
                                                  : ShownUnitOf(unit).name);
  }
  return units;
}

Json PlatesJson(const ContactRun& run) {
  Json json = Json::array();
  const ObservationFit& fit = run.calibrated.estimate.fit;
  for (std::size_t p = 0; p < run.model.setup.plates.size(); ++p) {
    if (run.calibrated.in_sample.by_plate[p].touches == 0) continue;
    const std::vector<int>& of = run.model.setup.instruments[p]->quantities;
    const QuantityValue& plate = fit.values.quantities[of[0]];
    const QuantityValue& table = fit.values.quantities[of[1]];
    const int plate_entry = fit.entry_of_quantity[of[0]];
    const int table_entry = fit.entry_of_quantity[of[1]];
    json.push_back({{"name", run.model.setup.plates[p].name},
                    {"touches", run.calibrated.in_sample.by_plate[p].touches},
                    {"tilts_deg", NumbersJson(plate.x, 0, 2, kDegreesOf)},
                    {"tilts_sd_deg", SdsJson(fit, plate_entry, 0, 2, kDegreesOf)},
                    {"table_height_mm", 1e3 * (table.origin.translation().z() + table.x[0])},
                    {"table_height_sd_mm", SdsJson(fit, table_entry, 0, 1, 1e3)[0]},
                    {"table_tilts_deg", NumbersJson(table.x, 1, 2, kDegreesOf)},
                    {"table_tilts_sd_deg", SdsJson(fit, table_entry, 1, 2, kDegreesOf)}});
  }
  return json;
}

/// Quantities on which instruments other than plates depend: origin, values and their standard
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
      const Eigen::Vector3d& p = value.origin.translation();
      const int size = static_cast<int>(value.x.size());
      json.push_back({{"name", run.model.setup.quantities[index].name},
                      {"origin_xyz_m", {p.x(), p.y(), p.z()}},
                      {"origin_rpy_rad", {rpy.x(), rpy.y(), rpy.z()}},
                      {"values", NumbersJson(value.x, 0, size, 1.0)},
                      {"sds", SdsJson(fit, fit.entry_of_quantity[index], 0, size, 1.0)},
                      {"units", UnitsJson(run.model.setup, index)}});
    }
  }
  return json;
}

/// Difference of each quantity in each session from its mean.
Json SessionEffectsJson(const ContactRun& run) {
  Json json = Json::array();
  const ObservationFit& fit = run.calibrated.estimate.fit;
  std::set<int> tables;
  for (std::size_t p = 0; p < run.model.setup.plates.size(); ++p) {
    tables.insert(run.model.setup.instruments[p]->quantities[1]);
  }
  std::vector<int> observations(run.observations.effects.size(), 0);
  for (const Observation& of : run.observations.all) {
    for (int effect : of.effects) ++observations[static_cast<std::size_t>(effect)];
  }
  for (std::size_t e = 0; e < observations.size(); ++e) {
    const SessionEffect& effect = run.observations.effects[e];
    const Eigen::VectorXd& x = fit.values.effects[e];
    const int entry = fit.entry_of_effect[e];
    json.push_back({{"quantity", run.model.setup.quantities[effect.quantity].name},
                    {"session", effect.name},
                    {"observations", observations[e]}});
    if (tables.contains(effect.quantity)) {
      json.back()["height_mm"] = 1e3 * x[0];
      json.back()["height_sd_mm"] = SdsJson(fit, entry, 0, 1, 1e3)[0];
      json.back()["tilts_deg"] = NumbersJson(x, 1, 2, kDegreesOf);
      json.back()["tilts_sd_deg"] = SdsJson(fit, entry, 1, 2, kDegreesOf);
    } else {
      const int size = static_cast<int>(x.size());
      json.back()["values"] = NumbersJson(x, 0, size, 1.0);
      json.back()["sds"] = SdsJson(fit, entry, 0, size, 1.0);
      json.back()["units"] = UnitsJson(run.model.setup, effect.quantity);
    }
  }
  return json;
}

/// Residual of an observation: height_mm and tilt_deg for touches, by rows for others.
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

}  // namespace

nlohmann::ordered_json ContactJson(const ContactRun& run) {
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
    json["kfold"]["decided_once"] = Json::array();
    if (run.springs_chosen) json["kfold"]["decided_once"].push_back("elasticity");
    if (run.without_causes) {
      json["kfold"]["decided_once"].push_back("causes");
      json["kfold"]["without_causes"] = FiguresJson(run.model, *run.without_causes);
    }
    json["kfold"]["uncalibrated"] = FiguresJson(run.model, run.uncalibrated.held_out.figures);
    json["kfold"]["of_touches"] = ObservationList(run, true);
    if (!run.touches_only()) json["kfold"]["of_others"] = ObservationList(run, false);
  }
  if (run.geometric) {
    json["urdf_alone"] = FiguresJson(run.model, ContactRun::Judged(*run.geometric));
    json["holds_with"] = CompensationOf(run);
  }
  json["gain_in_sds"] = run.gain_in_sds;
  json["plates"] = PlatesJson(run);
  json["session_effects"] = SessionEffectsJson(run);
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

}  // namespace elastocal
