// SPDX-License-Identifier: Apache-2.0
#include "elastocal/fleet/family.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/validation/significance.hpp"

namespace elastocal {
namespace {

constexpr double kManyTimes = 3.0;  // ratio to the median error
constexpr std::size_t kFewestRobots = 3;

/// One robot's estimate of a parameter.
struct Value {
  std::size_t member = 0;
  double value = 0.0, sd = 0.0;
};

struct Values {
  std::string unit;
  std::vector<Value> all;
};

/// For each parameter: the estimates that the data tell.
std::map<std::string, Values> CollectValues(const std::vector<FleetMember>& members) {
  std::map<std::string, Values> values;
  for (std::size_t m = 0; m < members.size(); ++m) {
    for (const ParameterEstimate& one : members[m].estimate.parameters) {
      if (one.external || one.status != ParameterStatus::kEstimated) continue;
      if (one.name.ends_with(".torque_bias")) continue;
      values[one.name].unit = one.unit;
      values[one.name].all.push_back({m, one.value, one.sd});
    }
  }
  return values;
}

/// Mean, and variance between robots beyond the uncertainty of their estimates.
struct Scatter {
  double mean = 0.0, variance = 0.0;
  int count = 0;

  /// Of the values for which `with` is true.
  template <typename Which>
  Scatter(const std::vector<Value>& values, Which with) {
    double uncertainty = 0.0;
    for (const Value& one : values) {
      if (!with(one)) continue;
      ++count;
      mean += one.value;
      uncertainty += one.sd * one.sd;
    }
    if (count == 0) return;
    mean /= count;
    double squares = 0.0;
    for (const Value& one : values) {
      if (with(one)) squares += (one.value - mean) * (one.value - mean);
    }
    if (count > 1) variance = std::max(0.0, squares / (count - 1) - uncertainty / count);
  }
};

/// Keeps the findings that are significant by Holm at the level, the smallest p first.
template <typename Finding>
std::vector<Finding> Significant(std::vector<Finding> findings, double level) {
  std::vector<double> p;
  for (const Finding& one : findings) p.push_back(one.p_adjusted);
  const std::vector<double> adjusted = HolmAdjusted(p);
  for (std::size_t i = 0; i < findings.size(); ++i) findings[i].p_adjusted = adjusted[i];
  std::erase_if(findings, [&](const Finding& one) { return !(one.p_adjusted <= level); });
  std::stable_sort(findings.begin(), findings.end(),
                   [](const Finding& a, const Finding& b) { return a.p_adjusted < b.p_adjusted; });
  return findings;
}

void AddOutOfFamily(const std::string& name, const Values& values,
                    const std::vector<FleetMember>& robots, std::vector<OutOfFamily>& findings) {
  for (const Value& one : values.all) {
    const Scatter others(values.all, [&](const Value& other) { return &other != &one; });
    if (others.count < 3) continue;
    const double sd = std::sqrt(others.variance * (1.0 + 1.0 / others.count) + one.sd * one.sd);
    const double p = StudentTwoSidedTail((one.value - others.mean) / sd, others.count - 1.0);
    findings.push_back(
        {robots[one.member].robot, name, values.unit, one.value, others.mean, sd, p});
  }
}

void AddBatches(const std::string& name, const Values& values,
                const std::vector<FleetMember>& robots, std::vector<BatchDifference>& findings) {
  std::set<std::string> batches;
  for (const Value& one : values.all) batches.insert(robots[one.member].batch);
  if (batches.size() < 2) return;
  for (const std::string& batch : batches) {
    if (batch.empty()) continue;
    const auto inside = [&](const Value& one) { return robots[one.member].batch == batch; };
    const auto variance_of = [&](bool own, Scatter& scatter) {
      double squares = 0.0;
      for (const Value& one : values.all) {
        if (inside(one) == own) squares += std::pow(one.value - scatter.mean, 2);
      }
      return squares / (scatter.count - 1.0) / scatter.count;
    };
    Scatter own(values.all, inside);
    Scatter others(values.all, [&](const Value& one) { return !inside(one); });
    if (own.count < 3 || others.count < 3) continue;
    const double a = variance_of(true, own), b = variance_of(false, others);
    const double freedom =
        (a + b) * (a + b) / (a * a / (own.count - 1.0) + b * b / (others.count - 1.0));
    const double difference = own.mean - others.mean, sd = std::sqrt(a + b);
    findings.push_back(
        {batch, name, values.unit, difference, sd, StudentTwoSidedTail(difference / sd, freedom)});
  }
}

void AddDrifts(const std::string& name, const Values& values,
               const std::vector<FleetMember>& members, std::vector<ParameterDrift>& findings) {
  std::map<std::string, std::vector<const Value*>> sessions;
  for (const Value& one : values.all) {
    if (members[one.member].day) sessions[members[one.member].robot].push_back(&one);
  }
  for (const auto& [robot, of] : sessions) {
    double weight = 0.0, time = 0.0, value = 0.0;
    for (const Value* one : of) {
      const double w = 1.0 / (one->sd * one->sd);
      weight += w;
      time += w * *members[one->member].day;
      value += w * one->value;
    }
    double squares = 0.0, product = 0.0;
    for (const Value* one : of) {
      const double w = 1.0 / (one->sd * one->sd);
      const double t = *members[one->member].day - time / weight;
      squares += w * t * t;
      product += w * t * (one->value - value / weight);
    }
    if (of.size() < 2 || !(squares > 0.0)) continue;
    const double slope = product / squares, sd = 1.0 / std::sqrt(squares);
    findings.push_back({robot, name, values.unit, slope, sd, StudentTwoSidedTail(slope / sd, 1e6)});
    for (const Value* one : of) {
      findings.back().sessions.push_back({*members[one->member].day, one->value, one->sd});
    }
  }
}

void FindWorkshop(const std::vector<FleetMember>& robots, FleetFamily& family) {
  std::vector<double> errors;
  for (const FleetMember& robot : robots) {
    if (std::isfinite(robot.urdf_error)) errors.push_back(robot.urdf_error);
  }
  std::sort(errors.begin(), errors.end());
  family.median_error = errors.empty() ? std::nan("") : errors[errors.size() / 2];
  for (const FleetMember& robot : robots) {
    const bool unlike =
        std::any_of(family.out_of_family.begin(), family.out_of_family.end(),
                    [&](const OutOfFamily& one) { return one.robot == robot.robot; });
    if (unlike || robot.urdf_error > kManyTimes * family.median_error) {
      family.workshop.push_back(robot.robot);
    }
  }
}

/// Kind of a parameter: "theta" of "joint.theta".
std::string KindOf(const std::string& name) { return name.substr(name.rfind('.') + 1); }

}  // namespace

std::vector<FleetMember> LastSessions(const std::vector<FleetMember>& members) {
  std::vector<FleetMember> last;
  for (const FleetMember& member : members) {
    const auto known = std::find_if(last.begin(), last.end(), [&](const FleetMember& one) {
      return one.robot == member.robot;
    });
    if (known == last.end()) {
      last.push_back(member);
    } else if (!known->day || (member.day && *member.day >= *known->day)) {
      *known = member;
    }
  }
  return last;
}

FleetFamily StudyFamily(const std::vector<FleetMember>& members, double level) {
  FleetFamily family;
  const std::vector<FleetMember> robots = LastSessions(members);
  for (const auto& [name, values] : CollectValues(robots)) {
    const Scatter all(values.all, [](const Value&) { return true; });
    family.parameters.push_back({name, values.unit, all.mean, std::sqrt(all.variance), all.count});
    AddOutOfFamily(name, values, robots, family.out_of_family);
    AddBatches(name, values, robots, family.batches);
  }
  for (const auto& [name, values] : CollectValues(members)) {
    AddDrifts(name, values, members, family.drifts);
  }
  family.out_of_family = Significant(std::move(family.out_of_family), level);
  family.batches = Significant(std::move(family.batches), level);
  family.drifts = Significant(std::move(family.drifts), level);
  FindWorkshop(robots, family);
  return family;
}

CalibrationEstimate FleetPrior(const std::vector<FleetMember>& robots, double kind_robots) {
  if (robots.size() < kFewestRobots) {
    throw InputError("a prior from " + std::to_string(robots.size()) +
                     " calibrated robots; at least three were expected");
  }
  std::map<std::string, std::size_t> seen;
  for (const FleetMember& robot : robots) {
    for (const std::string& name : robot.estimate.covariance_names) ++seen[name];
  }
  CalibrationEstimate prior = robots.front().estimate;
  std::erase_if(prior.parameters, [&](const ParameterEstimate& one) {
    return one.external || seen[one.name] != robots.size();
  });
  const auto count = static_cast<Eigen::Index>(prior.parameters.size());
  const auto number = static_cast<double>(robots.size());
  Eigen::MatrixXd estimates(count, static_cast<Eigen::Index>(robots.size()));
  prior.covariance.setZero(count, count);
  for (std::size_t r = 0; r < robots.size(); ++r) {
    const CalibrationEstimate& of = robots[r].estimate;
    std::map<std::string, double> values;
    for (const ParameterEstimate& one : of.parameters) values[one.name] = one.value;
    std::map<std::string, int> row;
    for (const std::string& name : of.covariance_names) {
      row.emplace(name, static_cast<int>(row.size()));
    }
    std::vector<int> rows;
    for (Eigen::Index i = 0; i < count; ++i) {
      const std::string& name = prior.parameters[static_cast<std::size_t>(i)].name;
      estimates(i, static_cast<Eigen::Index>(r)) = values[name];
      rows.push_back(row[name]);
    }
    prior.covariance += of.covariance(rows, rows) / number;
  }
  const Eigen::VectorXd mean = estimates.rowwise().mean();
  const Eigen::VectorXd scatter = (estimates.colwise() - mean).rowwise().squaredNorm() / number;
  std::map<std::string, std::pair<double, double>> of_kind;
  for (Eigen::Index i = 0; i < count; ++i) {
    auto& [sum, members] = of_kind[KindOf(prior.parameters[static_cast<std::size_t>(i)].name)];
    sum += scatter[i];
    members += 1.0;
  }
  prior.covariance_names.clear();
  for (Eigen::Index i = 0; i < count; ++i) {
    ParameterEstimate& one = prior.parameters[static_cast<std::size_t>(i)];
    const auto& [sum, members] = of_kind[KindOf(one.name)];
    prior.covariance(i, i) +=
        (number * scatter[i] + kind_robots * sum / members) / (number + kind_robots);
    one.value = mean[i];
    one.sd = std::sqrt(prior.covariance(i, i));
    one.status = ParameterStatus::kEstimated;
    prior.covariance_names.push_back(one.name);
  }
  prior.recording = "a fleet of " + std::to_string(robots.size()) + " robots";
  return prior;
}

}  // namespace elastocal
