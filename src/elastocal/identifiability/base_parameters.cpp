// SPDX-License-Identifier: Apache-2.0
#include "elastocal/identifiability/base_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "elastocal/identifiability/regressor.hpp"
#include "elastocal/math/priority_qr.hpp"
#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

constexpr Eigen::Index kMostFree = 300;  // postures with a free root

/// Rank of a kind in the paper's order; lower comes first.
int PriorityClass(ParameterKind kind, ExternalPriority external) {
  switch (kind) {
    case ParameterKind::kTheta:
      return 0;
    case ParameterKind::kR:
    case ParameterKind::kD:
    case ParameterKind::kB:
      return 1;
    case ParameterKind::kAlpha:
    case ParameterKind::kBeta:
    case ParameterKind::kGamma:
      return 2;
    case ParameterKind::kRod:
    case ParameterKind::kMotorZero:
      return 3;  // after the parameters of the tree
    case ParameterKind::kWaistPose:
      return external == ExternalPriority::kFirst ? -2 : 4;
    default:
      return external == ExternalPriority::kFirst ? -1 : 5;
  }
}

/// Counts the identifiable parameters by the joints that move a marker. A leg that only supports
/// the robot moves none. With a free root, a joint that moves all markers has no visible effect.
int TheoreticalCount(const ErrorModel& model, RootPose root) {
  const bool free = root == RootPose::kFree;
  std::map<int, int> moved;  // by joint: markers
  for (const Marker& marker : model.markers) {
    for (int k : JointsToBody(model.tree, model.tree.links[marker.link].body)) ++moved[k];
  }
  int count = 3 * model.marker_count() - (free ? kWaistParameterCount : 0);
  for (const auto& [joint, markers] : moved) {
    if (free && markers == model.marker_count()) continue;
    count += model.tree.joints[joint].type == JointType::kRevolute ? 4 : 2;
  }
  return std::max(0, count);
}

std::vector<int> Sorted(std::vector<int> values) {
  std::sort(values.begin(), values.end());
  return values;
}

/// Positions of `values` after sorting, so that a matrix can be put into the same order.
std::vector<int> SortingOrder(const std::vector<int>& values) {
  std::vector<int> order(values.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return values[a] < values[b]; });
  return order;
}

/// Keeps all elastic parameters, with nothing regrouped into them, because geometry does not decide
/// on them.
void KeepElastic(const ErrorModel& model, BaseParameters& base) {
  std::vector<int> kept = base.kept;
  for (int i = 0; i < model.parameter_count(); ++i) {
    const bool held = std::binary_search(base.held.begin(), base.held.end(), i);
    if (IsElastic(model.parameters[i].kind) && !held) kept.push_back(i);
  }
  std::sort(kept.begin(), kept.end());
  Eigen::MatrixXd regrouping =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(kept.size()), base.regrouping.cols());
  for (std::size_t i = 0; i < base.kept.size(); ++i) {
    const auto at = std::lower_bound(kept.begin(), kept.end(), base.kept[i]) - kept.begin();
    regrouping.row(at) = base.regrouping.row(static_cast<Eigen::Index>(i));
  }
  base.kept = std::move(kept);
  base.regrouping = std::move(regrouping);
}

}  // namespace

std::vector<Share> RegroupedInto(const BaseParameters& base, int dropped) {
  constexpr double kSmallest = 1e-9;
  std::vector<Share> shares;
  for (std::size_t i = 0; i < base.kept.size(); ++i) {
    const double coefficient = base.regrouping(static_cast<Eigen::Index>(i), dropped);
    if (std::abs(coefficient) >= kSmallest) shares.push_back({base.kept[i], coefficient});
  }
  return shares;
}

Eigen::MatrixXd NominalFactor(const ErrorModel& model, const Eigen::MatrixXd& q, RootPose root) {
  const Geometry geometry = ApplyErrors(model, Eigen::VectorXd::Zero(model.parameter_count()));
  if (root == RootPose::kConstant) return RegressorFactor(model, geometry, q, {});
  return FreeRootFactor(model, geometry, q.topRows(std::min(q.rows(), kMostFree)));
}

Eigen::MatrixXd NominalFactor(const ErrorModel& model, const IdentifiabilityOptions& options) {
  Random random(options.seed);
  Eigen::MatrixXd q(options.postures, model.tree.coordinate_count());
  for (int i = 0; i < options.postures; ++i) q.row(i) = RandomPosture(model.tree, random);
  return NominalFactor(model, q, options.root);
}

BaseParameters FindBaseParameters(const ErrorModel& model, const Eigen::MatrixXd& factor,
                                  const IdentifiabilityOptions& options) {
  BaseParameters base;
  base.held = MatchParameters(model.parameters, options.hold);
  std::vector<int> order;
  for (int i = 0; i < model.parameter_count(); ++i) {
    if (IsElastic(model.parameters[i].kind)) continue;
    if (!std::binary_search(base.held.begin(), base.held.end(), i)) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return PriorityClass(model.parameters[a].kind, options.external) <
           PriorityClass(model.parameters[b].kind, options.external);
  });

  const PriorityQrResult qr = PriorityQr(factor(Eigen::all, order), options.tolerance);
  std::vector<int> kept, dropped;
  for (int i : qr.kept) {
    kept.push_back(order[i]);
    base.smallest_kept = std::min(base.smallest_kept, qr.remainder[i]);
  }
  for (int i : qr.dropped) {
    dropped.push_back(order[i]);
    base.largest_dropped = std::max(base.largest_dropped, qr.remainder[i]);
  }
  base.regrouping = qr.regrouping(SortingOrder(kept), SortingOrder(dropped));
  base.kept = Sorted(kept);
  base.dropped = Sorted(dropped);
  base.geometric_count = static_cast<int>(kept.size());
  KeepElastic(model, base);
  base.theoretical_count =
      TheoreticalCount(model, options.root) +
      static_cast<int>(std::count_if(base.kept.begin(), base.kept.end(),
                                     [&](int i) { return model.parameters[i].linkage >= 0; }));
  return base;
}

BaseParameters FindBaseParameters(const ErrorModel& model, const IdentifiabilityOptions& options) {
  return FindBaseParameters(model, NominalFactor(model, options), options);
}

std::vector<int> LostBySpecialMarkers(const ErrorModel& model,
                                      const IdentifiabilityOptions& options) {
  ErrorModel generic = model;
  Random random(options.seed);
  const double shift = 0.05 * RobotSize(model.tree);
  for (Marker& marker : generic.markers) marker.p_link_marker += random.NormalVector(3, shift);
  const std::vector<int> with_special = FindBaseParameters(model, options).kept;
  const std::vector<int> with_generic = FindBaseParameters(generic, options).kept;
  std::vector<int> lost;
  std::set_difference(with_generic.begin(), with_generic.end(), with_special.begin(),
                      with_special.end(), std::back_inserter(lost));
  return lost;
}

}  // namespace elastocal
