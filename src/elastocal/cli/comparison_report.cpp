// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/comparison_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "elastocal/cli/figures.hpp"
#include "elastocal/cli/moved_joints_report.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/pipeline/check_json.hpp"
#include "elastocal/pipeline/earlier_calibration.hpp"
#include "elastocal/robot/parameter_names.hpp"

namespace elastocal::cli {
namespace {

using Json = nlohmann::ordered_json;

/// Units for people, as in InUserUnits.
struct UserScale {
  double factor;
  std::string unit;
};

UserScale ScaleOf(const std::string& unit) {
  if (unit == "rad") return {180.0 / M_PI, "deg"};
  if (unit == "m") return {1e3, "mm"};
  if (unit == "rad/(N.m)") return {1e6, "urad/(N.m)"};
  if (unit == "m/N") return {1e6, "um/N"};
  return {1.0, unit};
}

constexpr int kRowsOfScreen = 10;

std::string MoreRows(int all, int shown) {
  return all > shown ? fmt::format("  and {} more: --verbose\n", all - shown) : "";
}

/// Table of joints, the most significant first: the first `most` rows, and all joints that moved.
std::string JointTable(const CalibrationComparison& comparison, int most) {
  TextTable table({"joint", "parameters", "F", "p", "p of all joints", "verdict"});
  int rows = 0;
  for (const JointDifference& joint : comparison.joints) {
    if (rows >= most && !joint.moved) continue;
    ++rows;
    table.Add({joint.joint, std::to_string(joint.test.parameters),
               std::isnan(joint.test.statistic) ? "-" : fmt::format("{:.2f}", joint.test.statistic),
               Probability(joint.test.p), Probability(joint.p_adjusted),
               joint.moved ? "moved" : "-"});
  }
  return table.Render() + MoreRows(static_cast<int>(comparison.joints.size()), rows);
}

/// Table of parameters by joint, the most significant first, also within a joint: the first
/// `most` rows, and the significant rows of joints that moved.
std::string ParameterTable(const CalibrationComparison& comparison, int most) {
  TextTable table({"parameter", "unit", "A", "B", "B - A", "sd", "95 % interval", ""});
  int rows = 0, all = 0;
  for (const JointDifference& joint : comparison.joints) {
    for (const int i : joint.parameters) {
      const ParameterDifference& one = comparison.parameters[i];
      if (all++ >= most && !(joint.moved && one.significant())) continue;
      ++rows;
      const auto& [factor, unit] = ScaleOf(one.unit);
      const double sd = factor * one.sd;
      table.Add({one.name, unit, RoundedTo(factor * one.a, sd), RoundedTo(factor * one.b, sd),
                 RoundedTo(factor * one.difference, sd), RoundedSd(sd),
                 RoundedInterval(factor * one.difference, factor * one.half_width, sd),
                 std::string(one.significant() ? "*" : "") +
                     (joint.moved && one.significant() ? " moved" : "")});
    }
  }
  return table.Render() + MoreRows(all, rows);
}

/// Text on what was not compared, one line for each reason.
std::string NotComparedText(const CalibrationComparison& comparison) {
  std::vector<std::pair<std::string, std::vector<Parameter>>> groups;
  for (const NotCompared& one : comparison.not_compared) {
    auto group = std::find_if(groups.begin(), groups.end(),
                              [&](const auto& known) { return known.first == one.reason; });
    if (group == groups.end()) group = groups.insert(groups.end(), {one.reason, {}});
    Parameter named{};
    named.name = one.name;
    group->second.push_back(named);
  }
  std::string text;
  for (const auto& [reason, parameters] : groups) {
    std::vector<int> all;
    for (std::size_t i = 0; i < parameters.size(); ++i) all.push_back(static_cast<int>(i));
    text += fmt::format("  {}: {}\n", reason, JoinNames(parameters, all));
  }
  return text.empty() ? "" : "\nNot compared\n" + text;
}

std::string Joined(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

std::vector<std::string> MovedJoints(const CalibrationComparison& comparison) {
  std::vector<std::string> names;
  for (const JointDifference& joint : comparison.joints) {
    if (joint.moved) names.push_back(joint.joint);
  }
  return names;
}

/// Text on other explanations for joints that seem to have moved.
std::string OtherExplanations(const CalibrationComparison& comparison) {
  std::string text;
  for (const JointDifference& joint : comparison.joints) {
    if (joint.or_markers.empty()) continue;
    text += fmt::format("  {}: or all markers on {} moved as one piece{}\n", joint.joint,
                        fmt::join(joint.or_markers, ", or on "),
                        joint.or_markers.size() > 1 ? " (one of these links)" : "");
  }
  return text;
}

std::string Conclusion(const CalibrationComparison& comparison, double level) {
  const std::vector<std::string> moved = MovedJoints(comparison);
  if (!moved.empty()) {
    const std::string question = AskWhereMostMoved(moved.size(), comparison.joints.size());
    return (question.empty() ? "" : "Most joints have moved" + question + "\n") +
           "Moved by more than their uncertainty: " + Joined(moved) + "\n" +
           OtherExplanations(comparison);
  }
  if (!comparison.changed) {
    return fmt::format(
        "No joint moved by more than its uncertainty (chance of a false alarm {:.3g} %).\n",
        100.0 * level);
  }
  const std::string together = fmt::format(
      "Together the differences are more than their uncertainty (p {}), but no joint can be "
      "singled "
      "out",
      Probability(comparison.overall.p));
  if (!comparison.with_covariance) return together + ".\n";
  const std::string alone =
      comparison.suspects.empty()
          ? "no joint alone would explain it"
          : "any one of these alone would explain it: " + Joined(comparison.suspects);
  return together + "; " + alone +
         ".\nErrors that the model does not have, such as elasticity, look the same.\n";
}

Json SideJson(const CalibrationEstimate& estimate) {
  return {{"calibration", estimate.source},
          {"recording", estimate.recording},
          {"model", estimate.model}};
}

Json TestJson(const DifferenceTest& test) {
  Json json;
  json["parameters"] = test.parameters;
  json["F"] = std::isnan(test.statistic) ? Json(nullptr) : Json(test.statistic);
  json["degrees_of_freedom"] =
      std::isinf(test.degrees_of_freedom) ? Json(nullptr) : Json(test.degrees_of_freedom);
  json["p"] = test.p;
  return json;
}

Json ParameterJson(const ParameterDifference& one) {
  Json json;
  json["name"] = one.name;
  json["joint"] = one.joint;
  json["unit"] = one.unit;
  json["a"] = one.a;
  json["b"] = one.b;
  json["difference"] = one.difference;
  json["sd"] = one.sd;
  json["interval_95"] = {one.difference - one.half_width, one.difference + one.half_width};
  json["p"] = one.p;
  json["significant"] = one.significant();
  return json;
}

}  // namespace

std::string DescribeComparison(const CalibrationEstimate& a, const CalibrationEstimate& b,
                               const CalibrationComparison& comparison,
                               const ComparisonOptions& options, bool verbose) {
  const int most = verbose ? std::numeric_limits<int>::max() : kRowsOfScreen;
  std::string text = Conclusion(comparison, options.level) + "\n";
  text += fmt::format("{}\n  A: {}, from {}\n  B: {}, from {}\n\n", b.robot, a.source, a.recording,
                      b.source, b.recording);
  text += JointTable(comparison, most);
  text +=
      "  all parameters of a joint together, whatever other joints did; p of all joints: adjusted "
      "for their number\n\n";
  text += ParameterTable(comparison, most);
  text += "  * differs at 95 %, looked at alone; one in twenty does so by chance\n";
  if (!comparison.markers.empty()) {
    text +=
        "  B - A is what is left where markers that stayed on their links are laid on each other: "
        "it need not be B less A\n";
  }
  if (verbose) {
    text += NotComparedText(comparison);
  } else if (!comparison.not_compared.empty()) {
    text += fmt::format("  parameters that are not compared: {}; why: --verbose\n",
                        comparison.not_compared.size());
  }
  if (!comparison.markers.empty()) text += "\n" + DescribeMarkers(comparison.markers);
  return text;
}

Json MakeComparisonJson(const CalibrationEstimate& a, const CalibrationEstimate& b,
                        const CalibrationComparison& comparison, const ComparisonOptions& options) {
  const std::vector<std::string> moved = MovedJoints(comparison);
  Json json;
  json["status"] = !moved.empty()       ? "moved"
                   : comparison.changed ? "changed, no joint singled out"
                                        : "unchanged";
  json["robot"] = b.robot;
  json["a"] = SideJson(a);
  json["b"] = SideJson(b);
  json["level"] = options.level;
  json["with_covariance"] = comparison.with_covariance;
  json["moved"] = moved;
  json["suspects"] = comparison.suspects;
  json["overall"] = TestJson(comparison.overall);
  json["joints"] = Json::array();
  json["parameters"] = Json::array();
  for (const JointDifference& joint : comparison.joints) {
    Json item{{"joint", joint.joint}};
    item.update(TestJson(joint.test));
    item["p_adjusted"] = joint.p_adjusted;
    item["moved"] = joint.moved;
    item["or_markers"] = joint.or_markers;
    json["joints"].push_back(item);
    for (const int i : joint.parameters) {
      json["parameters"].push_back(ParameterJson(comparison.parameters[i]));
    }
  }
  json["markers"] = MarkersJson(comparison.markers);
  json["not_compared"] = Json::array();
  for (const NotCompared& one : comparison.not_compared) {
    json["not_compared"].push_back({{"name", one.name}, {"reason", one.reason}});
  }
  json["warnings"] = comparison.warnings;
  return json;
}

std::string DescribeSoleChanges(const std::vector<SoleDifference>& soles) {
  if (soles.empty()) return "";
  TextTable table({"sole of", "A, um/N", "B, um/N", "B - A", "95 % interval", ""});
  for (const SoleDifference& sole : soles) {
    const double sd = 1e6 * sole.sd, difference = 1e6 * (sole.b - sole.a);
    table.Add({sole.leg, RoundedTo(1e6 * sole.a, sd), RoundedTo(1e6 * sole.b, sd),
               RoundedTo(difference, sd), RoundedInterval(difference, 1e6 * sole.half_width, sd),
               sole.significant() ? "changed" : ""});
  }
  return "\nSprings of soles, which are no part of the verdict on the joints\n" + table.Render();
}

Json SoleDifferencesJson(const std::vector<SoleDifference>& soles) {
  Json json = Json::array();
  for (const SoleDifference& sole : soles) {
    const double difference = sole.b - sole.a;
    json.push_back({{"leg", sole.leg},
                    {"unit", "m/N"},
                    {"a", sole.a},
                    {"b", sole.b},
                    {"difference", difference},
                    {"sd", sole.sd},
                    {"interval_95", {difference - sole.half_width, difference + sole.half_width}},
                    {"significant", sole.significant()}});
  }
  return json;
}

}  // namespace elastocal::cli
