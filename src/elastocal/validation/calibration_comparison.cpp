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
#include "elastocal/validation/paired_estimates.hpp"

namespace elastocal {
namespace {

/// Differences of the robot's parameters, under the condition that the markers of links marked
/// `same` have not moved.
Differences OfRobot(const PairedEstimates& pair, const std::vector<LinkMarkers>& links) {
  return GivenNone(pair.differences, pair.robot, RowsOfUnmoved(pair.markers, links));
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

/// Test of a joint without correlations (Bonferroni), which holds for any correlation.
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

/// Corrects p values for the number of joints and sorts the joints, the most significant first.
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

/// Joints of which one alone explains all differences.
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

/// Tests of the joints and of everything together.
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

int CountMoved(const std::vector<JointDifference>& joints) {
  return static_cast<int>(std::ranges::count_if(joints, &JointDifference::moved));
}

/// Tests each joint and everything together, and stores the results.
void JudgeRobot(const PairedEstimates& pair, double level, CalibrationComparison& comparison) {
  const Differences all = OfRobot(pair, comparison.markers);
  for (std::size_t i = 0; i < comparison.parameters.size(); ++i) {
    SetDifference(all, static_cast<int>(i), comparison.parameters[i]);
  }
  Findings found = TestAll(all, level, comparison);
  comparison.joints = std::move(found.joints);
  comparison.overall = found.overall;
  const bool some_moved = CountMoved(comparison.joints) > 0;
  comparison.changed = some_moved || comparison.overall.p <= level;
  comparison.suspects.clear();
  if (comparison.changed && !some_moved && comparison.with_covariance) {
    comparison.suspects = FindSuspects(all, comparison.joints, level);
  }
}

/// Leaves out the condition on the markers of one link after another, since they may have moved as
/// one piece. If a joint is then no longer significant, the link is added to its `or_markers`. If
/// the link explains all differences and not exactly one joint is significant, its markers are
/// taken to have moved.
void LeaveLinksOpen(const PairedEstimates& pair, double level, CalibrationComparison& comparison) {
  for (std::size_t k = 0; k < comparison.markers.size() && comparison.changed; ++k) {
    if (!comparison.markers[k].same) continue;
    comparison.markers[k].same = false;
    const Findings open = TestAll(OfRobot(pair, comparison.markers), level, comparison);
    const bool explains = CountMoved(open.joints) == 0 && open.overall.p > level;
    if (explains && CountMoved(comparison.joints) != 1) {
      comparison.markers[k].as_one_piece = true;
      JudgeRobot(pair, level, comparison);
      return;
    }
    comparison.markers[k].same = true;
    for (JointDifference& joint : comparison.joints) {
      const auto there = std::ranges::find(open.joints, joint.joint, &JointDifference::joint);
      if (joint.moved && !there->moved) joint.or_markers.push_back(comparison.markers[k].link);
    }
  }
}

/// Decides which markers moved, and fills in all tests.
void Judge(const PairedEstimates& pair, double level, CalibrationComparison& comparison) {
  FindUnmovedMarkers(pair.differences, pair.markers, level, comparison.markers);
  JudgeRobot(pair, level, comparison);
  LeaveLinksOpen(pair, level, comparison);
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

/// The names of parameters; of many only the first.
std::string NamesOf(const std::vector<FixedParameter>& parameters) {
  constexpr std::size_t kMost = 8;
  std::string names;
  for (std::size_t i = 0; i < std::min(kMost, parameters.size()); ++i) {
    names += (i == 0 ? "" : ", ") + parameters[i].name;
  }
  if (parameters.size() <= kMost) return names;
  return names + " and " + std::to_string(parameters.size() - kMost) + " more";
}

/// Adds a warning that names the parameters that one side alone estimates.
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

/// Removes comparisons that have no meaning under the common model.
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

  PairedEstimates pair = PairEstimates(a, b, common.common, full, full && !options.new_markers);
  comparison.markers = std::move(pair.links);
  for (const CommonParameter& one : common.common) {
    comparison.parameters.push_back({.name = one.name,
                                     .joint = one.joint,
                                     .unit = one.unit,
                                     .a = a.parameters[Size(one.in_a)].value,
                                     .b = b.parameters[Size(one.in_b)].value});
  }
  try {
    Judge(pair, options.level, comparison);
  } catch (const std::invalid_argument&) {
    throw InputError(a.source + ", " + b.source + ": the covariances are not positive definite");
  }
  return comparison;
}

}  // namespace elastocal
