// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/diagnose.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "elastocal/io/marker_places_file.hpp"
#include "elastocal/mistakes/read_accepting.hpp"
#include "elastocal/pipeline/calibrated_robot.hpp"
#include "elastocal/pipeline/cause_picture_json.hpp"
#include "elastocal/pipeline/choose_model.hpp"
#include "elastocal/pipeline/contact_run.hpp"
#include "elastocal/pipeline/earlier_calibration.hpp"
#include "elastocal/pipeline/known_places.hpp"
#include "elastocal/pipeline/leave_out_touches.hpp"
#include "elastocal/recorded/choose_elasticity.hpp"
#include "elastocal/tables/json_text.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kLevel = 0.05;

/// Variable of a cause, as text.
const char* ByWhat(CorrectionShape shape) {
  switch (shape) {
    case CorrectionShape::kSin:
    case CorrectionShape::kCos:
      return "once a turn of the joint";
    case CorrectionShape::kSinTwice:
    case CorrectionShape::kCosTwice:
      return "twice a turn of the joint";
    case CorrectionShape::kGear:
      return "by its position";
    case CorrectionShape::kCoupling:
      return "by the position of the other joint";
    case CorrectionShape::kBacklash:
      return "by the sign of its load";
    case CorrectionShape::kHysteresis:
      return "by the direction of its last motion";
    case CorrectionShape::kStiffening:
      return "by the square of its load, at its largest torque";
    case CorrectionShape::kHours:
      return "by time";
    case CorrectionShape::kMass:
    case CorrectionShape::kFirstMoment:
      return "by what its weight bends";
    case CorrectionShape::kGravityTilt:
      return "by what the weight of all links bends";
    default:
      return "by the moment of the weight on the base";
  }
}

struct Shown {
  double factor;
  const char* unit;
};

Shown ShownAs(ParameterUnit unit) {
  switch (unit) {
    case ParameterUnit::kRadian:
      return {1e3, "mrad"};
    case ParameterUnit::kMetre:
      return {1e3, "mm"};
    case ParameterUnit::kRadianPerNewtonMetre:
      return {1e6, "urad/(N.m)"};
    case ParameterUnit::kRatio:
      return {1e2, "%"};
    case ParameterUnit::kPerNewton:
      return {1e6, "um/(N.m)"};
    case ParameterUnit::kMetrePerHour:
      return {1e3, "mm/h"};
    case ParameterUnit::kMetrePerRadian:
      return {1e3, "mm/rad"};
    case ParameterUnit::kRadianPerMetre:
      return {1e3, "mrad/m"};
    default:
      return {1.0, UnitName(unit)};
  }
}

const Parameter& ParameterOf(const CauseReport& report, int index) {
  return report.parameters[static_cast<std::size_t>(index)];
}

/// Estimate that represents a cause: the amplitude of an eccentricity or of a tilt, else the
/// parameter that is known best.
std::string SizeOf(const CauseReport& report, const CauseFinding& finding) {
  std::size_t surest = 0;
  for (std::size_t i = 0; i < finding.estimate.size(); ++i) {
    if (std::abs(finding.estimate[i]) / finding.sd[i] >
        std::abs(finding.estimate[surest]) / finding.sd[surest]) {
      surest = i;
    }
  }
  const Parameter& parameter = ParameterOf(report, finding.parameters[surest]);
  const auto [factor, unit] = ShownAs(parameter.unit);
  double value = finding.estimate[surest];
  const bool harmonic = parameter.name.ends_with("_sin") || parameter.name.ends_with("_cos");
  const bool tilt = parameter.name.starts_with("gravity.");
  if ((harmonic || tilt) && finding.estimate.size() == 2) {
    value = std::hypot(finding.estimate[0], finding.estimate[1]);
  }
  // Both end at the second significant digit of the standard deviation.
  const double sd = factor * finding.sd[surest];
  const int decimals = std::isfinite(sd) && sd > 0.0
                           ? std::clamp(1 - static_cast<int>(std::floor(std::log10(sd))), 0, 8)
                           : 2;
  return fmt::format("{:.{}f} +- {:.{}f} {}", factor * value, decimals, sd, decimals, unit);
}

/// Stores an error under its name with the unit: mm, or standard deviations of noise.
void SetError(const CauseReport& report, const std::string& name, double error, Json& json) {
  json[name + "_" + report.error_unit()] = report.error_factor() * error;
}

const char* UnitInWords(const CauseReport& report) {
  return report.in_metres ? "mm" : "standard deviations of noise";
}

/// Decimals with which a number is written: two, or more where two significant digits need them.
int DecimalsOf(double number) {
  return number > 0.0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(number))), 2, 6) : 2;
}

std::string ErrorInWords(const CauseReport& report, double error) {
  const double shown = report.error_factor() * error;
  return fmt::format("{:.{}f} {}", shown, DecimalsOf(shown), UnitInWords(report));
}

/// A change of errors as text: "from 2.66 to 2.30 mm", with at least two significant digits in the
/// difference.
std::string FallInWords(const CauseReport& report, double before, double after) {
  const double factor = report.error_factor(), fall = factor * std::abs(before - after);
  const int decimals = DecimalsOf(fall);
  return fmt::format("from {:.{}f} to {:.{}f} {}", factor * before, decimals, factor * after,
                     decimals, UnitInWords(report));
}

Json CandidateJson(const CauseReport& report, const CauseFinding& finding) {
  Json json;
  json["name"] = finding.cause;
  json["score"] = finding.score;
  json["p"] = finding.p;
  json["p_adjusted"] = finding.p_adjusted;
  SetError(report, "gain", finding.gain, json);
  SetError(report, "mean_gain", finding.mean_gain, json);
  SetError(report, "mean_gain_sd", finding.gain_sd, json);
  SetError(report, "visible", finding.visible, json);
  for (std::size_t i = 0; i < finding.parameters.size(); ++i) {
    const Parameter& parameter = ParameterOf(report, finding.parameters[i]);
    Json one;
    one["parameter"] = parameter.name;
    one["unit"] = UnitName(parameter.unit);
    one["value"] = finding.estimate[i];
    one["sd"] = finding.sd[i];
    json["estimate"].push_back(std::move(one));
  }
  json["words"] = DescribeCause(report, finding);
  if (!finding.rivals.empty()) json["rivals"] = finding.rivals;
  return json;
}

}  // namespace

Diagnosis Diagnose(const fs::path& folder, const fs::path& project_file,
                   std::optional<std::uint64_t> seed) {
  const auto start = std::chrono::steady_clock::now();
  CalibratedRobot robot = OpenCalibratedRobot(folder, project_file);
  const std::vector<fs::path> recordings = RecordedRecordings(robot);
  Project& project = robot.project;
  const auto as_calibrated = [&] {
    const std::vector<std::string> extra = project.elasticity.extra;
    project.elasticity = ElasticityOf(robot.calibration, project);
    project.elasticity.extra = extra;
  };
  Diagnosis diagnosis;
  const Assumptions told = RecordedAssumptions(robot);
  if (project.contact) {
    ContactStart begin = StartContacts(
        project, recordings, {.accept = told.accept, .prior = told.prior, .days = told.days});
    // As calibrate does, before it chooses springs.
    if (auto left_out = WithoutTouchesInTheAir(begin.model, begin.observations)) {
      begin.observations = std::move(left_out->others);
      diagnosis.warnings.push_back(left_out->text + "; left out, as by calibrate");
    }
    as_calibrated();
    if (!begin.earlier) {
      begin.model = MakeRobotOfProject(project, {begin.observations, begin.model.setup, {}});
    }
    diagnosis.report =
        StudyObservedCauses(project, begin.model, begin.observations,
                            EstimateObserved(begin.model, begin.observations, {}).fit, seed);
    diagnosis.recording = fmt::format("{}", fmt::join(begin.observations.files, ", "));
  } else {
    const Measurements measured = ReadAccepting(project, recordings, told.accept).measured;
    if (told.prior.empty()) {
      as_calibrated();
    } else {
      StartFromEarlier(told.prior, told.days, measured, seed, project);
    }
    if (told.marker_places.empty()) diagnosis.warnings = WarnOfIdleMarkerPlaces(recordings);
    std::vector<std::string> said_by_calibrate;
    const std::vector<MarkerMeasurement> places =
        OpenMarkerPlaces(told.marker_places, project, measured.calibration, {}, said_by_calibrate);
    diagnosis.report = StudyCauses(project, WithMarkersInOnePlace(measured, project), seed, places);
    diagnosis.recording = measured.calibration.source;
  }
  diagnosis.calibration_fingerprint = robot.calibration.fingerprint;
  diagnosis.inputs = robot.inputs;
  diagnosis.inputs.insert(diagnosis.inputs.end(), recordings.begin(), recordings.end());
  diagnosis.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return diagnosis;
}

std::string DescribeCause(const CauseReport& report, const CauseFinding& finding) {
  const Parameter& parameter = ParameterOf(report, finding.parameters.front());
  const Correction& correction = report.corrections[static_cast<std::size_t>(parameter.correction)];
  const std::size_t dot = finding.cause.rfind('.');
  std::string what = finding.cause.substr(dot + 1);
  constexpr std::string_view kCoupling = "coupling_";  // the name of the other joint stays
  if (what.starts_with(kCoupling)) {
    what.replace(0, kCoupling.size(), "coupling to ");
  } else {
    std::replace(what.begin(), what.end(), '_', ' ');
  }
  return fmt::format("{}: {} of {}, {}; the held-out error {} by {:.2g} {}",
                     finding.cause.substr(0, dot), what, SizeOf(report, finding),
                     ByWhat(correction.shape), finding.gain >= 0.0 ? "falls" : "rises",
                     report.error_factor() * std::abs(finding.gain), UnitInWords(report));
}

std::vector<std::string> DescribeDiagnosis(const CauseReport& report) {
  const CauseSearch& search = report.search;
  std::vector<std::string> sentences;
  if (search.findings.empty()) {
    return {"Too few postures to look for causes."};
  }
  const auto significant =
      std::count_if(search.findings.begin(), search.findings.end(),
                    [](const CauseFinding& finding) { return finding.p_adjusted < kLevel; });
  if (search.accepted) {
    sentences.push_back(fmt::format(
        "{} of {} causes together take the held-out error {} (nested folds):", search.chosen.size(),
        search.findings.size(), FallInWords(report, search.error, search.nested_error)));
    for (const CauseFinding& finding : search.chosen) {
      sentences.push_back("  " + DescribeCause(report, finding));
      if (finding.rivals.empty()) continue;
      sentences.push_back(
          fmt::format("    almost as well explained by {}: the recording does not "
                      "tell which it is",
                      fmt::join(finding.rivals, " or ")));
    }
  } else if (significant > 0) {
    sentences.push_back(fmt::format(
        "{} of {} causes are significant, but no choice of them lowers the held-out error of {} so "
        "far that it is worth it (nested folds):",
        significant, search.findings.size(), ErrorInWords(report, search.error)));
    for (const CauseFinding& finding : search.findings) {
      if (finding.p_adjusted >= kLevel) break;
      sentences.push_back("  " + DescribeCause(report, finding));
    }
  } else {
    std::vector<double> visible;
    for (const CauseFinding& finding : search.findings) visible.push_back(finding.visible);
    std::sort(visible.begin(), visible.end());
    sentences.push_back(fmt::format(
        "None of {} causes was found. One that moves {} by {} (root mean square, beside "
        "what is calibrated) would have been found nine times in ten.",
        search.findings.size(), report.in_metres ? "the markers" : "what was observed",
        ErrorInWords(report, visible[visible.size() / 2])));
  }
  return sentences;
}

std::string MakeDiagnosisJson(const Diagnosis& diagnosis) {
  const CauseSearch& search = diagnosis.report.search;
  Json json;
  json["calibration_fingerprint"] = diagnosis.calibration_fingerprint;
  json["recording"] = diagnosis.recording;
  json["postures"] = diagnosis.report.postures;
  SetError(diagnosis.report, "held_out", search.error, json);
  json["accepted"] = search.accepted;
  if (!search.chosen.empty()) {
    SetError(diagnosis.report, "nested", search.nested_error, json);
    SetError(diagnosis.report, "nested_gain", search.nested_gain, json);
    SetError(diagnosis.report, "nested_gain_sd", search.nested_gain_sd, json);
  }
  json["chosen"] = Json::array();
  for (const CauseFinding& finding : search.chosen) {
    json["chosen"].push_back(CandidateJson(diagnosis.report, finding));
  }
  json["words"] = DescribeDiagnosis(diagnosis.report);
  json["pictures"] = CausePicturesJson(diagnosis.report);
  json["candidates"] = Json::array();
  for (const CauseFinding& finding : search.findings) {
    json["candidates"].push_back(CandidateJson(diagnosis.report, finding));
  }
  return JsonText(json);
}

}  // namespace elastocal
