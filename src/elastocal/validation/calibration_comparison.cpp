#include "elastocal/validation/calibration_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

double DegreesOfFreedom(const CalibrationEstimate& estimate) {
  return StudentDegreesOfFreedom(0.975, estimate.interval_factor);
}

/// Covariance of all parameters of an estimate; zero for those without an entry in the covariance.
Eigen::MatrixXd FullCovariance(const CalibrationEstimate& estimate, bool from_file,
                               const Eigen::VectorXd& used) {
  const auto size = static_cast<Eigen::Index>(estimate.parameters.size());
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(size, size);
  if (!from_file) {
    for (Eigen::Index i = 0; i < size; ++i) {
      if (used[i] != 0.0) full(i, i) = std::pow(estimate.parameters[i].sd, 2);
    }
    return full;
  }
  std::map<std::string, Eigen::Index> row;
  for (const std::string& name : estimate.covariance_names) {
    row.emplace(name, static_cast<Eigen::Index>(row.size()));
  }
  std::vector<Eigen::Index> here, there;
  for (Eigen::Index i = 0; i < size; ++i) {
    if (used[i] == 0.0) continue;
    const auto at = row.find(estimate.parameters[i].name);
    if (at == row.end()) {
      throw InputError(estimate.source + ": its covariance has no parameter '" +
                       estimate.parameters[i].name + "'");
    }
    here.push_back(i);
    there.push_back(at->second);
  }
  full(here, here) = estimate.covariance(there, there);
  return full;
}

Eigen::VectorXd Values(const CalibrationEstimate& estimate) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(estimate.parameters.size()));
  for (Eigen::Index i = 0; i < values.size(); ++i) values[i] = estimate.parameters[i].value;
  return values;
}

/// Weights of one calibration, quantities x parameters.
Eigen::MatrixXd Weights(const std::vector<CommonParameter>& common,
                        Eigen::VectorXd CommonParameter::*weights) {
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(common.size()), (common[0].*weights).size());
  for (std::size_t i = 0; i < common.size(); ++i) {
    matrix.row(static_cast<Eigen::Index>(i)) = common[i].*weights;
  }
  return matrix;
}

Eigen::MatrixXd Propagated(const CalibrationEstimate& estimate, bool from_file,
                           const Eigen::MatrixXd& weights) {
  const Eigen::VectorXd used = weights.cwiseAbs().colwise().sum();
  return weights * FullCovariance(estimate, from_file, used) * weights.transpose();
}

std::map<std::string, double> NamedWeights(const CalibrationEstimate& estimate,
                                           const Eigen::VectorXd& weights) {
  std::map<std::string, double> named;
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    if (weights[i] != 0.0) named[estimate.parameters[i].name] = weights[i];
  }
  return named;
}

ParameterDifference MakeDifference(const CommonParameter& common, const CalibrationEstimate& a,
                                   const CalibrationEstimate& b, const Differences& all, int i) {
  ParameterDifference one{.name = common.name, .joint = common.joint, .unit = common.unit};
  one.a = common.weights_a.dot(Values(a));
  one.b = common.weights_b.dot(Values(b));
  one.difference = all.values[i];
  const double variance_a = all.covariance_a(i, i);
  const double variance = variance_a + all.covariance_b(i, i);
  one.sd = std::sqrt(variance);
  one.degrees_of_freedom = PooledFreedom(all, variance_a / variance);
  one.half_width = one.sd * StudentQuantile(0.975, one.degrees_of_freedom);
  one.p = StudentTwoSidedTail(one.difference / one.sd, one.degrees_of_freedom);
  one.stands_for = common.stands_for;
  one.weights_a = NamedWeights(a, common.weights_a);
  one.weights_b = NamedWeights(b, common.weights_b);
  const bool plain =
      one.weights_a.size() == 1 && one.weights_a.contains(one.name) && one.weights_b.size() == 1;
  if (plain) {
    one.weights_a.clear();
    one.weights_b.clear();
  }
  return one;
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
      joints.push_back({.joint = parameters[i].joint, .parameters = {}, .test = {}});
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

/// Fills in the tests of joints and of everything together.
void Judge(const Differences& all, double level, CalibrationComparison& comparison) {
  const auto test = [&](const std::vector<int>& which) {
    return comparison.with_covariance ? TestDifferences(all, which)
                                      : TestBySmallest(comparison.parameters, which);
  };
  comparison.joints = GroupByJoint(comparison.parameters);
  for (JointDifference& joint : comparison.joints) joint.test = test(joint.parameters);
  JudgeJoints(level, comparison.joints);
  comparison.overall = test(AllOf(comparison.parameters.size()));
  const bool some_moved = comparison.joints.front().moved;
  comparison.changed = some_moved || comparison.overall.p <= level;
  if (comparison.changed && !some_moved && comparison.with_covariance) {
    comparison.suspects = FindSuspects(all, comparison.joints, level);
  }
}

void CheckSameRobot(const CalibrationEstimate& a, const CalibrationEstimate& b) {
  if (a.nominal == b.nominal) return;
  throw InputError(a.source + " is of robot '" + a.robot + "' and " + b.source + " of robot '" +
                   b.robot + "' with other nominal geometry: only two calibrations of one URDF " +
                   "can be compared");
}

/// Adds to `names` the parameters that are held in `holder` and estimated in `other`.
void AddHeldInOneOnly(const CalibrationEstimate& holder, const CalibrationEstimate& other,
                      std::string& names) {
  for (const ParameterEstimate& held : holder.parameters) {
    if (held.status != ParameterStatus::kHeld) continue;
    for (const ParameterEstimate& parameter : other.parameters) {
      if (parameter.name != held.name || parameter.status != ParameterStatus::kEstimated) continue;
      names += (names.empty() ? "" : ", ") + held.name;
    }
  }
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
  std::string held;
  AddHeldInOneOnly(a, b, held);
  AddHeldInOneOnly(b, a, held);
  if (!held.empty()) {
    comparison.warnings.push_back(
        "held in one calibration only, whose other estimates contain their deviation from " +
        std::string("nominal: ") + held);
  }
  if (!comparison.with_covariance) {
    comparison.warnings.emplace_back(
        "without covariance.csv of both, parameters are tested one by one: joints are found less "
        "easily");
  }
}

}  // namespace

CalibrationComparison CompareCalibrations(const CalibrationEstimate& a,
                                          const CalibrationEstimate& b,
                                          const ComparisonOptions& options) {
  CheckSameRobot(a, b);
  CalibrationComparison comparison;
  const bool full = a.has_covariance() && b.has_covariance();
  comparison.with_covariance = full;
  CommonParameters common = FindCommonParameters(a, b, full);
  if (common.common.empty()) {
    throw InputError(
        a.source + " and " + b.source +
        ": no parameter of the robot is estimated in both, so nothing can be compared");
  }
  comparison.not_compared = std::move(common.not_compared);
  AddWarnings(a, b, comparison);

  const Eigen::MatrixXd weights_a = Weights(common.common, &CommonParameter::weights_a);
  const Eigen::MatrixXd weights_b = Weights(common.common, &CommonParameter::weights_b);
  Differences all{.values = weights_b * Values(b) - weights_a * Values(a),
                  .covariance_a = Propagated(a, full, weights_a),
                  .covariance_b = Propagated(b, full, weights_b)};
  all.freedom_a = DegreesOfFreedom(a);
  all.freedom_b = DegreesOfFreedom(b);
  for (std::size_t i = 0; i < common.common.size(); ++i) {
    comparison.parameters.push_back(
        MakeDifference(common.common[i], a, b, all, static_cast<int>(i)));
  }
  try {
    Judge(all, options.level, comparison);
  } catch (const std::invalid_argument&) {
    throw InputError(a.source + ", " + b.source + ": the covariances are not positive definite");
  }
  return comparison;
}

}  // namespace elastocal
