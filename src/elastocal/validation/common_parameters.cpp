#include "elastocal/validation/common_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "elastocal/math/priority_qr.hpp"

namespace elastocal {
namespace {

constexpr double kSameCoefficient = 1e-6;  // regrouping is exact up to rounding
constexpr double kDependent = 1e-6;        // relative remainder of a column

/// Coefficients of a combination, by parameter name.
using Content = std::map<std::string, double>;

/// The combination for which each estimated parameter of the robot stands; other parameters have
/// none.
struct Side {
  const CalibrationEstimate& estimate;
  std::map<std::string, int> index;  // of all parameters, by name
  std::map<int, Content> content;    // of those that can be compared
  std::set<int> mixed;               // those that contain external parameters
};

Side MakeSide(const CalibrationEstimate& estimate, const std::set<std::string>& held) {
  Side side{.estimate = estimate, .index = {}, .content = {}, .mixed = {}};
  for (std::size_t i = 0; i < estimate.parameters.size(); ++i) {
    const ParameterEstimate& parameter = estimate.parameters[i];
    side.index[parameter.name] = static_cast<int>(i);
    if (parameter.external || parameter.status != ParameterStatus::kEstimated) continue;
    if (!held.contains(parameter.name)) side.content[static_cast<int>(i)][parameter.name] = 1.0;
  }
  for (const ParameterEstimate& dropped : estimate.parameters) {
    if (held.contains(dropped.name)) continue;
    for (const auto& [kept, coefficient] : dropped.regrouped_into) {
      const auto at = side.index.find(kept);
      if (at == side.index.end() || !side.content.contains(at->second)) continue;
      if (std::abs(coefficient) < kSameCoefficient) continue;
      side.content[at->second][dropped.name] = coefficient;
      if (dropped.external) side.mixed.insert(at->second);
    }
  }
  for (const int i : side.mixed) side.content.erase(i);
  return side;
}

std::set<std::string> HeldNames(const CalibrationEstimate& estimate) {
  std::set<std::string> names;
  for (const ParameterEstimate& parameter : estimate.parameters) {
    if (parameter.status == ParameterStatus::kHeld) names.insert(parameter.name);
  }
  return names;
}

bool SameContent(const Content& a, const Content& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
    return x.first == y.first && std::abs(x.second - y.second) < kSameCoefficient;
  });
}

CommonParameter MakeCommon(const Side& a, const Side& b, int parameter_b) {
  const ParameterEstimate& parameter = b.estimate.parameters[parameter_b];
  CommonParameter common{
      .name = parameter.name,
      .joint = OwnerName(parameter.name),
      .unit = parameter.unit,
      .weights_a = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(a.estimate.parameters.size())),
      .weights_b = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(b.estimate.parameters.size())),
      .stands_for = b.content.at(parameter_b)};
  common.weights_b[parameter_b] = 1.0;
  common.stands_for.erase(parameter.name);
  return common;
}

/// The contents as columns, with one row for each parameter name.
Eigen::MatrixXd ContentColumns(const std::vector<const Content*>& contents) {
  std::map<std::string, Eigen::Index> row;
  for (const Content* content : contents) {
    for (const auto& entry : *content)
      row.emplace(entry.first, static_cast<Eigen::Index>(row.size()));
  }
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(row.size()),
                                                  static_cast<Eigen::Index>(contents.size()));
  for (std::size_t c = 0; c < contents.size(); ++c) {
    for (const auto& [name, coefficient] : *contents[c]) {
      columns(row.at(name), static_cast<Eigen::Index>(c)) = coefficient;
    }
  }
  return columns;
}

/// Adds quantities beyond the equal parameters: one for each parameter of B in `rest_b` whose
/// content depends linearly on those of A and of earlier ones in `rest_b`.
void AddCombinations(const Side& a, const Side& b, const std::vector<int>& rest_b,
                     std::vector<CommonParameter>& common) {
  std::vector<int> parameters;
  std::vector<const Content*> contents;
  for (const auto& [i, content] : a.content) {
    parameters.push_back(i);
    contents.push_back(&content);
  }
  const auto count_a = static_cast<int>(parameters.size());
  for (const int i : rest_b) {
    parameters.push_back(i);
    contents.push_back(&b.content.at(i));
  }
  const PriorityQrResult qr = PriorityQr(ContentColumns(contents), kDependent);
  for (std::size_t d = 0; d < qr.dropped.size(); ++d) {
    if (qr.dropped[d] < count_a) continue;
    CommonParameter entry = MakeCommon(a, b, parameters[qr.dropped[d]]);
    for (std::size_t k = 0; k < qr.kept.size(); ++k) {
      const double coefficient =
          qr.regrouping(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(d));
      if (std::abs(coefficient) < kSameCoefficient) continue;
      const int parameter = parameters[qr.kept[k]];
      if (qr.kept[k] < count_a) {
        entry.weights_a[parameter] = coefficient;
      } else {
        entry.weights_b[parameter] = -coefficient;
      }
    }
    common.push_back(std::move(entry));
  }
}

std::string StatusIn(const Side& side, const std::string& name) {
  const auto at = side.index.find(name);
  if (at == side.index.end()) return "absent";
  return StatusName(side.estimate.parameters[at->second].status);
}

/// The reason why a parameter of the robot is in no common quantity.
std::string Reason(const Side& a, const Side& b, const std::string& name) {
  const std::string in_a = StatusIn(a, name);
  const std::string in_b = StatusIn(b, name);
  const std::string estimated = StatusName(ParameterStatus::kEstimated);
  if (in_a != estimated || in_b != estimated) {
    return in_a == in_b ? in_a + " in both" : in_a + " in A, " + in_b + " in B";
  }
  if (a.mixed.contains(a.index.at(name)) || b.mixed.contains(b.index.at(name))) {
    return "cannot be told from where the waist and the markers are";
  }
  return "stands for different combinations of parameters in A and B";
}

void AddNotCompared(const Side& a, const Side& b, CommonParameters& result) {
  std::set<std::string> used;
  for (const CommonParameter& common : result.common) {
    for (const auto& [side, weights] :
         {std::pair{&a, &common.weights_a}, {&b, &common.weights_b}}) {
      for (Eigen::Index i = 0; i < weights->size(); ++i) {
        if ((*weights)[i] != 0.0) used.insert(side->estimate.parameters[i].name);
      }
    }
  }
  std::set<std::string> listed;
  for (const Side* side : {&a, &b}) {
    for (const ParameterEstimate& parameter : side->estimate.parameters) {
      if (parameter.external || used.contains(parameter.name)) continue;
      if (!listed.insert(parameter.name).second) continue;
      result.not_compared.push_back({parameter.name, Reason(a, b, parameter.name)});
    }
  }
}

}  // namespace

std::string OwnerName(const std::string& parameter) {
  if (parameter.ends_with(".torque_bias")) return parameter;
  return parameter.substr(0, parameter.rfind('.'));
}

CommonParameters FindCommonParameters(const CalibrationEstimate& a, const CalibrationEstimate& b,
                                      bool with_combinations) {
  std::set<std::string> held = HeldNames(a);
  held.merge(HeldNames(b));
  const Side side_a = MakeSide(a, held);
  const Side side_b = MakeSide(b, held);
  CommonParameters result;
  std::vector<int> rest_b;
  for (const auto& [i, content] : side_b.content) {
    const auto in_a = side_a.index.find(b.parameters[i].name);
    const bool same = in_a != side_a.index.end() && side_a.content.contains(in_a->second) &&
                      SameContent(side_a.content.at(in_a->second), content);
    if (!same) {
      rest_b.push_back(i);
      continue;
    }
    result.common.push_back(MakeCommon(side_a, side_b, i));
    result.common.back().weights_a[in_a->second] = 1.0;
  }
  if (with_combinations && !rest_b.empty() && !side_a.content.empty()) {
    AddCombinations(side_a, side_b, rest_b, result.common);
  }
  AddNotCompared(side_a, side_b, result);
  return result;
}

}  // namespace elastocal
