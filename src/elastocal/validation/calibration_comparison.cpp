// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/calibration_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/validation/conditioned_estimate.hpp"

namespace elastocal {
namespace {

double DegreesOfFreedom(const CalibrationEstimate& estimate) {
  return StudentDegreesOfFreedom(0.975, estimate.interval_factor);
}

/// Covariance of some parameters of an estimate; without a file of it, of their variances alone.
Eigen::MatrixXd CovarianceOf(const CalibrationEstimate& estimate, bool from_file,
                             const std::vector<int>& parameters) {
  if (!from_file) {
    Eigen::VectorXd variances(static_cast<Eigen::Index>(parameters.size()));
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      variances[static_cast<Eigen::Index>(i)] = std::pow(estimate.parameters[parameters[i]].sd, 2);
    }
    return variances.asDiagonal();
  }
  std::map<std::string, int> row;
  for (const std::string& name : estimate.covariance_names) {
    row.emplace(name, static_cast<int>(row.size()));
  }
  std::vector<int> rows;
  for (int parameter : parameters) {
    const auto at = row.find(estimate.parameters[parameter].name);
    if (at == row.end()) {
      throw InputError(estimate.source + ": its covariance has no parameter '" +
                       estimate.parameters[parameter].name + "'");
    }
    rows.push_back(at->second);
  }
  return estimate.covariance(rows, rows);
}

/// All differences, and which of their rows are the robot's and which the markers' by link.
struct Comparable {
  Differences all;
  std::vector<int> robot;
  std::vector<std::vector<int>> markers;
};

/// Those of the robot's parameters first. `comparison` takes the parameters and the links.
Comparable MakeComparable(const CalibrationEstimate& a, const CalibrationEstimate& b,
                          const std::vector<CommonParameter>& common,
                          const ComparisonOptions& options, CalibrationComparison& comparison) {
  std::vector<int> in_a, in_b;
  std::vector<double> values;
  const auto add = [&](int at_a, int at_b, double nominal_difference) {
    in_a.push_back(at_a);
    in_b.push_back(at_b);
    values.push_back(b.parameters[Size(at_b)].value - a.parameters[Size(at_a)].value +
                     nominal_difference);
    return static_cast<int>(values.size()) - 1;
  };
  Comparable made;
  for (const CommonParameter& one : common) {
    made.robot.push_back(add(one.in_a, one.in_b, 0.0));
    comparison.parameters.push_back({.name = one.name,
                                     .joint = one.joint,
                                     .unit = one.unit,
                                     .a = a.parameters[Size(one.in_a)].value,
                                     .b = b.parameters[Size(one.in_b)].value});
  }
  if (comparison.with_covariance && !options.new_markers) {
    comparison.markers = FindCommonMarkers(a, b);
  }
  for (const LinkMarkers& link : comparison.markers) {
    made.markers.emplace_back();
    for (const MarkerCoordinate& one : CoordinatesOf(link, a, b)) {
      made.markers.back().push_back(add(one.in_a, one.in_b, one.nominal_difference));
    }
  }
  made.all = {.values = Eigen::VectorXd::Map(values.data(), std::ssize(values)),
              .covariance_a = CovarianceOf(a, comparison.with_covariance, in_a),
              .covariance_b = CovarianceOf(b, comparison.with_covariance, in_b),
              .freedom_a = DegreesOfFreedom(a),
              .freedom_b = DegreesOfFreedom(b)};
  constexpr double kReturns = kMarkerReturns * kMarkerReturns;
  for (const std::vector<int>& link : made.markers) {
    for (const int row : link) {
      made.all.covariance_a(row, row) += 0.5 * kReturns;
      made.all.covariance_b(row, row) += 0.5 * kReturns;
    }
  }
  return made;
}

/// The robot's differences, if the markers on links where they are the same have not moved.
Differences OfRobot(const Comparable& comparable, const std::vector<LinkMarkers>& links) {
  return GivenNone(comparable.all, comparable.robot, RowsOfUnmoved(comparable.markers, links));
}

void SetDifference(const Differences& all, int i, ParameterDifference& one) {
  one.difference = all.values[i];
  const double variance_a = all.covariance_a(i, i);
  const double variance = variance_a + all.covariance_b(i, i);
  one.sd = std::sqrt(variance);
  one.degrees_of_freedom = PooledFreedom(all, variance_a / variance);
  one.half_width = one.sd * StudentQuantile(0.975, one.degrees_of_freedom);
  one.p = StudentTwoSidedTail(one.difference / one.sd, one.degrees_of_freedom);
}

/// A joint's test without correlations, which holds whatever they are.
DifferenceTest TestBySmallest(const std::vector<ParameterDifference>& parameters,
                              const std::vector<int>& which) {
  DifferenceTest test;
  test.statistic = std::numeric_limits<double>::quiet_NaN();
  test.parameters = static_cast<int>(which.size());
  test.degrees_of_freedom = std::numeric_limits<double>::infinity();
  for (const int i : which) {
    test.p = std::min(test.p, parameters[i].p * test.parameters);
    test.degrees_of_freedom = std::min(test.degrees_of_freedom, parameters[i].degrees_of_freedom);
  }
  return test;
}

std::vector<int> AllOf(std::size_t count) {
  std::vector<int> all(count);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

std::vector<JointDifference> GroupByJoint(const std::vector<ParameterDifference>& parameters) {
  std::vector<JointDifference> joints;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    auto joint = std::find_if(joints.begin(), joints.end(), [&](const JointDifference& known) {
      return known.joint == parameters[i].joint;
    });
    if (joint == joints.end()) {
      joints.push_back(
          {.joint = parameters[i].joint, .parameters = {}, .test = {}, .or_markers = {}});
      joint = std::prev(joints.end());
    }
    joint->parameters.push_back(static_cast<int>(i));
  }
  for (JointDifference& joint : joints) {
    std::stable_sort(joint.parameters.begin(), joint.parameters.end(),
                     [&](int a, int b) { return parameters[a].p < parameters[b].p; });
  }
  return joints;
}

/// Adjusts p values for the number of joints, and puts the most significant joint first.
void JudgeJoints(double level, std::vector<JointDifference>& joints) {
  std::vector<double> p;
  for (const JointDifference& joint : joints) p.push_back(joint.test.p);
  const std::vector<double> adjusted = HolmAdjusted(p);
  for (std::size_t k = 0; k < joints.size(); ++k) {
    joints[k].p_adjusted = adjusted[k];
    joints[k].moved = adjusted[k] <= level;
  }
  std::stable_sort(joints.begin(), joints.end(),
                   [](const JointDifference& a, const JointDifference& b) {
                     if (a.test.p != b.test.p) return a.test.p < b.test.p;
                     return a.test.statistic > b.test.statistic;
                   });
}

/// Joints of which one alone would explain all differences.
std::vector<std::string> FindSuspects(const Differences& all,
                                      const std::vector<JointDifference>& joints, double level) {
  const std::vector<int> everything = AllOf(static_cast<std::size_t>(all.values.size()));
  std::vector<std::string> suspects;
  for (const JointDifference& joint : joints) {
    if (joint.parameters.size() == everything.size() ||
        TestDifferences(all, everything, joint.parameters).p > level) {
      suspects.push_back(joint.joint);
    }
  }
  return suspects;
}

/// The joints with their tests, the most significant first.
std::vector<JointDifference> TestJoints(const Differences& all, double level,
                                        const CalibrationComparison& comparison) {
  std::vector<JointDifference> joints = GroupByJoint(comparison.parameters);
  for (JointDifference& joint : joints) {
    joint.test = comparison.with_covariance
                     ? TestDifferences(all, joint.parameters)
                     : TestBySmallest(comparison.parameters, joint.parameters);
  }
  JudgeJoints(level, joints);
  return joints;
}

/// What the differences of the robot say.
struct Findings {
  std::vector<JointDifference> joints;
  DifferenceTest overall;
};

Findings TestAll(const Differences& all, double level, const CalibrationComparison& comparison) {
  const std::vector<int> everything = AllOf(comparison.parameters.size());
  return {.joints = TestJoints(all, level, comparison),
          .overall = comparison.with_covariance
                         ? TestDifferences(all, everything)
                         : TestBySmallest(comparison.parameters, everything)};
}

/// Leaves the markers of one link after another open, which may have moved as one piece. Where a
/// joint is then no longer accused, it names the link beside it. Of the tests of everything it
/// keeps the one that accuses least.
void LeaveLinksOpen(const Comparable& comparable, double level, CalibrationComparison& comparison) {
  for (std::size_t k = 0; k < comparison.markers.size(); ++k) {
    if (!comparison.markers[k].same) continue;
    std::vector<LinkMarkers> links = comparison.markers;
    links[k].same = false;
    const Findings open = TestAll(OfRobot(comparable, links), level, comparison);
    if (open.overall.p > comparison.overall.p) comparison.overall = open.overall;
    for (JointDifference& joint : comparison.joints) {
      const auto there = std::ranges::find(open.joints, joint.joint, &JointDifference::joint);
      if (joint.moved && !there->moved) joint.or_markers.push_back(links[k].link);
    }
  }
}

/// Fills in the tests of markers, joints and everything together.
void Judge(const Comparable& comparable, double level, CalibrationComparison& comparison) {
  FindUnmovedMarkers(comparable.all, comparable.markers, level, comparison.markers);
  const Differences all = OfRobot(comparable, comparison.markers);
  for (std::size_t i = 0; i < comparison.parameters.size(); ++i) {
    SetDifference(all, static_cast<int>(i), comparison.parameters[i]);
  }
  Findings found = TestAll(all, level, comparison);
  comparison.joints = std::move(found.joints);
  comparison.overall = found.overall;
  LeaveLinksOpen(comparable, level, comparison);
  const bool some_moved = comparison.joints.front().moved;
  comparison.changed = some_moved || comparison.overall.p <= level;
  if (comparison.changed && !some_moved && comparison.with_covariance) {
    comparison.suspects = FindSuspects(all, comparison.joints, level);
  }
}

void CheckSameRobot(const CalibrationEstimate& a, const CalibrationEstimate& b) {
  if (a.nominal != b.nominal) {
    throw InputError(a.source + " is of robot '" + a.robot + "' and " + b.source + " of robot '" +
                     b.robot + "' with other nominal geometry: only two calibrations of one URDF " +
                     "can be compared");
  }
  if (a.gauge == b.gauge) return;
  throw InputError(a.source + " has the gauge '" + a.gauge + "' and " + b.source + " '" + b.gauge +
                   "': the frame of the root link is elsewhere, and with it the errors of all "
                   "joints on it; two calibrations with one gauge were expected");
}

/// The names of parameters, and of many the first few.
std::string NamesOf(const std::vector<FixedParameter>& parameters) {
  constexpr std::size_t kMost = 8;
  std::string names;
  for (std::size_t i = 0; i < std::min(kMost, parameters.size()); ++i) {
    names += (i == 0 ? "" : ", ") + parameters[i].name;
  }
  if (parameters.size() <= kMost) return names;
  return names + " and " + std::to_string(parameters.size() - kMost) + " more";
}

/// Says what one side alone estimates.
void AddModelWarning(const std::string& side, const std::string& other,
                     const std::vector<FixedParameter>& fixed, CalibrationComparison& comparison) {
  if (fixed.empty()) return;
  const std::string names = side + " alone estimates " + NamesOf(fixed) + ": ";
  comparison.warnings.push_back(
      names + (comparison.with_covariance
                   ? "its other estimates are compared as they would be with these fixed as in " +
                         other + "; what they would explain may then look like a moved joint"
                   : "what they explain is in the other estimates of " + other));
}

void AddWarnings(const CalibrationEstimate& a, const CalibrationEstimate& b,
                 CalibrationComparison& comparison) {
  if (a.recording == b.recording) {
    comparison.warnings.push_back(
        "both name the recording " + a.recording +
        "; if it is the same one, their errors are not independent, and the test means nothing");
  }
  if (a.model != b.model) {
    comparison.warnings.push_back(
        "A has the model " + a.model + ", B the model " + b.model +
        ": effects that one of them does not model are in its other estimates");
  }
  if (!comparison.with_covariance) {
    comparison.warnings.emplace_back(
        "without covariance.csv of both, parameters are tested one by one: joints are found less "
        "easily");
  }
}

bool HasLoad(const std::vector<FixedParameter>& parameters) {
  return std::ranges::any_of(parameters,
                             [](const FixedParameter& one) { return IsLoad(one.name); });
}

/// Takes those away that mean nothing under what both models have.
void DropIncomparable(const CalibrationEstimate& a, const CalibrationEstimate& b, bool other_loads,
                      CommonParameters& common) {
  std::erase_if(common.common, [&](const CommonParameter& one) {
    const char* reason = nullptr;
    if (a.parameters[one.in_a].status != ParameterStatus::kEstimated ||
        b.parameters[one.in_b].status != ParameterStatus::kEstimated) {
      reason = "not positive without what one of them alone estimates";
    } else if (other_loads && IsSpring(one.name)) {
      reason = "the models differ in what loads the joints";
    }
    if (reason != nullptr) common.not_compared.push_back({one.name, reason});
    return reason != nullptr;
  });
}

}  // namespace

CalibrationComparison CompareCalibrations(const CalibrationEstimate& given_a,
                                          const CalibrationEstimate& given_b,
                                          const ComparisonOptions& options) {
  CheckSameRobot(given_a, given_b);
  CalibrationComparison comparison;
  const bool full = given_a.has_covariance() && given_b.has_covariance();
  comparison.with_covariance = full;
  const std::vector<FixedParameter> in_a_alone = FixedIn(given_b, given_a);
  const std::vector<FixedParameter> in_b_alone = FixedIn(given_a, given_b);
  AddWarnings(given_a, given_b, comparison);
  AddModelWarning("A", "B", in_a_alone, comparison);
  AddModelWarning("B", "A", in_b_alone, comparison);
  const CalibrationEstimate a = full ? Conditioned(given_a, in_a_alone) : given_a;
  const CalibrationEstimate b = full ? Conditioned(given_b, in_b_alone) : given_b;
  CommonParameters common = FindCommonParameters(given_a, given_b);
  DropIncomparable(a, b, HasLoad(in_a_alone) || HasLoad(in_b_alone), common);
  if (common.common.empty()) {
    throw InputError(
        a.source + " and " + b.source +
        ": no parameter of the robot is estimated in both, so nothing can be compared");
  }
  comparison.not_compared = std::move(common.not_compared);

  const Comparable comparable = MakeComparable(a, b, common.common, options, comparison);
  try {
    Judge(comparable, options.level, comparison);
  } catch (const std::invalid_argument&) {
    throw InputError(a.source + ", " + b.source + ": the covariances are not positive definite");
  }
  return comparison;
}

}  // namespace elastocal
