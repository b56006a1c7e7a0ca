// SPDX-License-Identifier: Apache-2.0
#include "elastocal/report/page.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "elastocal/math/input_error.hpp"
#include "elastocal/report/csv_columns.hpp"
#include "elastocal/report/encoding.hpp"
#include "elastocal/report/json_reader.hpp"
#include "elastocal/tables/json_text.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kPlace = "\"@ELASTOCAL_REPORT_DATA@\"";
constexpr std::size_t kMostCurveRows = 20000;
constexpr std::size_t kMostMotionRows = 800;

std::string WithoutSuffix(const std::string& name, std::string_view suffix) {
  return name.ends_with(suffix) ? name.substr(0, name.size() - suffix.size()) : std::string();
}

Json Number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json CalibrationJson(const LabelledCalibration& calibration) {
  Json json = {{"label", calibration.label},
               {"recording", calibration.estimate.recording},
               {"parameters", Json::array()}};
  for (const ParameterEstimate& parameter : calibration.estimate.parameters) {
    if (parameter.external) continue;
    json["parameters"].push_back({{"name", parameter.name},
                                  {"unit", parameter.unit},
                                  {"value", parameter.value},
                                  {"sd", Number(parameter.sd)},
                                  {"status", StatusName(parameter.status)}});
  }
  return json;
}

/// Correlation coefficients in hundredths, one byte each: the lower triangle, row by row.
Json CorrelationJson(const CalibrationEstimate& estimate) {
  const Eigen::MatrixXd& covariance = estimate.covariance;
  std::string lower;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      const double scale = std::sqrt(covariance(i, i) * covariance(j, j));
      const double coefficient = scale > 0.0 ? covariance(i, j) / scale : 0.0;
      lower += static_cast<char>(std::lround(100.0 * std::clamp(coefficient, -1.0, 1.0)));
    }
  }
  return {{"names", estimate.covariance_names}, {"lower", Base64(lower)}};
}

/// Path of a file of the folder, for messages.
std::string PathOf(const ReportSources& sources, const std::string& name) {
  return (std::filesystem::path(sources.folder) / name).string();
}

Json DesignJson(const ReportSources& sources) {
  Json json;
  for (const auto& [name, text] : sources.files) {
    std::size_t rows = 0;
    if (name.ends_with("_curves.csv")) {
      json["curves"] = ReadCsvColumns(PathOf(sources, name), text, kMostCurveRows, rows);
    } else if (name.ends_with("_summary.json")) {
      json["summary"] = ParseJsonObject(PathOf(sources, name), text);
    }
  }
  return json;
}

Json MotionsJson(const ReportSources& sources) {
  Json json = Json::array();
  for (const auto& [name, text] : sources.files) {
    const std::string stem = WithoutSuffix(name, ".csv");
    if (stem.empty() || stem.ends_with("_curves")) continue;
    std::size_t rows = 0;
    Json motion = {{"name", stem},
                   {"columns", ReadCsvColumns(PathOf(sources, name), text, kMostMotionRows, rows)}};
    motion["rows"] = rows;
    const auto margins = sources.files.find(stem + "_margins.json");
    if (margins != sources.files.end())
      motion["margins"] = ParseJsonObject(PathOf(sources, margins->first), margins->second);
    json.push_back(std::move(motion));
  }
  return json;
}

bool IsOutdated(const ReportSources& sources, const std::string& name) {
  return std::find(sources.outdated.begin(), sources.outdated.end(), name) !=
         sources.outdated.end();
}

/// What the page lacks, with the command that makes it.
Json MissingJson(const Json& report, const ReportSources& sources) {
  const std::string& folder = sources.folder;
  Json missing = Json::array();
  const auto add = [&](const std::string& what, const std::string& command) {
    missing.push_back({{"what", what}, {"command", command}});
  };
  for (const std::string& name : sources.outdated) {
    add(name + " is of another calibration than calibration.yaml",
        name == "deployment.json"
            ? "elastocal simulate PROJECT --deploy " + folder + " --motion MOTION.csv -o " + folder
        : name == "diagnosis.json"
            ? "elastocal diagnose " + folder + " --json " + folder + "/" + name
            : "elastocal validate PROJECT --calibration " + folder +
                  "/calibration.yaml --recording RECORDING -o " + folder);
  }
  const Json data = report.value("data", Json::object());
  if (!report.contains("summary") || !report.contains("data")) {
    add("Calibration", "elastocal calibrate PROJECT --recording RECORDING -o " + folder);
  } else {
    if (data.value("error_table", Json::object()).empty()) {
      add("Errors on held-out motions",
          "elastocal calibrate, with trials of kind sine, random or repeatability in the "
          "recording");
    }
    if (data.value("signals", Json::array()).empty()) {
      add("Filtered signals", "elastocal calibrate, with a recording folder instead of a table");
    }
  }
  if (!report.contains("validation") && !IsOutdated(sources, "validation.json")) {
    add("Another recording", "elastocal validate PROJECT --calibration " + folder +
                                 "/calibration.yaml --recording RECORDING -o " + folder);
  }
  if (!report.contains("design")) {
    add("Choice of the postures", "elastocal design PROJECT -o " + folder + "/postures.yaml");
  }
  if (report["motions"].empty()) {
    add("The planned motion", "elastocal plan PROJECT --postures " + folder + "/postures.yaml -o " +
                                  folder + "/motion.csv");
  }
  if (report["calibrations"].size() < 2) {
    add("Calibrations over time", "elastocal report " + folder + " --earlier EARLIER_FOLDER");
  }
  return missing;
}

}  // namespace

std::vector<std::string> ReportFiles(const std::vector<std::string>& names) {
  static const std::vector<std::string> known = {
      "summary.json",   "report_data.json", "validation.json", "comparison.json", "deployment.json",
      "diagnosis.json", "robot_data.json",  "runs.json",       "motion.csv"};
  const auto has = [](const std::vector<std::string>& list, const std::string& name) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  std::vector<std::string> files;
  for (const std::string& name : names) {
    const std::string stem = WithoutSuffix(name, ".csv");
    if (has(known, name) || name.ends_with("_curves.csv") || name.ends_with("_summary.json") ||
        name.ends_with("_margins.json") || (!stem.empty() && has(names, stem + "_margins.json"))) {
      files.push_back(name);
    }
  }
  return files;
}

std::string MakeReportJson(const ReportSources& sources) {
  Json report = {
      {"format", "elastocal-report-1"}, {"version", sources.version}, {"folder", sources.folder}};
  for (const auto& [key, name] :
       {std::pair{"summary", "summary.json"}, std::pair{"data", "report_data.json"},
        std::pair{"validation", "validation.json"}, std::pair{"comparison", "comparison.json"},
        std::pair{"deployment", "deployment.json"}, std::pair{"diagnosis", "diagnosis.json"},
        std::pair{"runs", "runs.json"}}) {
    const auto file = sources.files.find(name);
    if (file != sources.files.end())
      report[key] = ParseJsonObject(PathOf(sources, name), file->second);
  }
  const auto robot = sources.files.find("robot_data.json");
  if (!report.contains("data") && robot != sources.files.end()) {
    report["data"] = ParseJsonObject(PathOf(sources, robot->first), robot->second);
  }
  report["calibrations"] = Json::array();
  for (const LabelledCalibration& calibration : sources.calibrations) {
    report["calibrations"].push_back(CalibrationJson(calibration));
  }
  if (!sources.calibrations.empty() && sources.calibrations.back().estimate.has_covariance()) {
    report["correlation"] = CorrelationJson(sources.calibrations.back().estimate);
  }
  if (Json design = DesignJson(sources); !design.is_null()) report["design"] = std::move(design);
  report["motions"] = MotionsJson(sources);
  report["missing"] = MissingJson(report, sources);
  return JsonLine(report);
}

std::string MakePage(std::string_view page_template, const std::string& json) {
  const std::size_t place = page_template.find(kPlace);
  if (place == std::string_view::npos) {
    throw std::invalid_argument("MakePage: the template has no place for the data");
  }
  std::string page(page_template.substr(0, place));
  page.reserve(page_template.size() + json.size());
  for (const char c : json) {
    // These occur only inside strings: "</script>" would close the element.
    if (c == '<') {
      page += "\\u003c";
    } else {
      page += c;
    }
  }
  page += page_template.substr(place + kPlace.size());
  return page;
}

}  // namespace elastocal
