// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/gauge.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "elastocal/calibration/placing_markers.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

// Step of the central differences, rad and m; it leaves an error of 1e-10.
constexpr double kGaugeStep = 1e-5;

/// Rotz(gamma) Trz(b) Rotx(alpha) Trx(d) Rotz(theta) Trz(r), alpha near 90 degrees.
struct SixConstants {
  double gamma = 0.0, b = 0.0, alpha = 0.0, d = 0.0, theta = 0.0, r = 0.0;

  explicit SixConstants(const Transform& T) {
    const Eigen::Matrix3d R = T.linear();
    alpha = std::atan2(std::hypot(R(0, 2), R(1, 2)), R(2, 2));
    gamma = std::atan2(R(0, 2), -R(1, 2));
    theta = std::atan2(R(2, 0), R(2, 1));
    const Eigen::Vector3d u = RotZ(-gamma).linear() * T.translation();
    d = u.x();
    r = -u.y() / std::sin(alpha);
    b = u.z() - r * std::cos(alpha);
  }
};

double Wrapped(double angle) { return std::remainder(angle, 2.0 * M_PI); }

/// Error of one constant of eq. 1: its present value less the nominal one.
double ConstantError(ParameterKind kind, const SixConstants& now, const JointPlacement& nominal) {
  switch (kind) {
    case ParameterKind::kGamma:
      return Wrapped(now.gamma - nominal.gamma);
    case ParameterKind::kB:
      return now.b - nominal.b;
    case ParameterKind::kAlpha:
      return Wrapped(now.alpha - nominal.alpha);
    case ParameterKind::kD:
      return now.d - nominal.d;
    case ParameterKind::kTheta:
      return Wrapped(now.theta - nominal.theta);
    default:
      return now.r - nominal.r;
  }
}

bool OnRoot(const ErrorModel& model, int joint) {
  return joint >= 0 && model.tree.joints[joint].parent_body == 0;
}

/// Whether a parameter is geometric and places a joint on the root.
bool PlacesOnRoot(const ErrorModel& model, const Parameter& parameter) {
  return OnRoot(model, parameter.joint) && parameter.leg < 0 && !IsElastic(parameter.kind);
}

/// The joint's frame in that of the root link, at position zero and without loads.
Transform JointInRoot(const Geometry& geometry, int joint) {
  const Geometry::JointConstants& constants = geometry.joints[joint];
  Transform T = Transform::Identity();
  T.linear() = constants.R_parent_twisted;
  T.translation() = constants.p_parent_twisted;
  return T * RotZ(constants.theta) * TrZ(constants.r);
}

Transform NominalInRoot(const ErrorModel& model, int joint) {
  return JointInRoot(ApplyErrors(model, Eigen::VectorXd::Zero(model.parameter_count())), joint);
}

/// The joint on the root that moves the link's body; -1: there is none in the model.
int JointOfLink(const ErrorModel& model, const std::string& link) {
  const int body = model.tree.links[FindLink(model.tree, link)].body;
  const bool active =
      std::binary_search(model.active_joints.begin(), model.active_joints.end(), body - 1);
  return body > 0 && active && OnRoot(model, body - 1) ? body - 1 : -1;
}

/// The errors that depend on the root link's frame.
std::vector<int> DisplacedErrors(const ErrorModel& model) {
  std::vector<int> displaced;
  for (int i = 0; i < model.parameter_count(); ++i) {
    const Parameter& parameter = model.parameters[i];
    const bool marker = parameter.kind == ParameterKind::kMarker &&
                        model.tree.links[model.markers[parameter.marker].link].body == 0;
    if (marker || parameter.kind == ParameterKind::kWaistPose || PlacesOnRoot(model, parameter)) {
      displaced.push_back(i);
    }
  }
  return displaced;
}

using ErrorMap = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

/// Derivative, among `parameters`, of a map that changes only the errors `displaced`.
Eigen::MatrixXd GaugeDerivative(const ErrorMap& map, const Eigen::VectorXd& at,
                                const std::vector<int>& displaced,
                                const std::vector<int>& parameters) {
  const auto count = static_cast<Eigen::Index>(parameters.size());
  Eigen::MatrixXd derivative = Eigen::MatrixXd::Identity(count, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const int i = parameters[static_cast<std::size_t>(k)];
    if (!std::binary_search(displaced.begin(), displaced.end(), i)) continue;
    Eigen::VectorXd plus = at;
    Eigen::VectorXd minus = at;
    plus[i] += kGaugeStep;
    minus[i] -= kGaugeStep;
    derivative.col(k) = ((map(plus) - map(minus)) / (2.0 * kGaugeStep))(parameters);
  }
  return derivative;
}

void DisplacePlacement(const Transform& T_root_new, Placement& placement) {
  for (Transform& T_ref_waist : placement.T_ref_waist) T_ref_waist = T_ref_waist * T_root_new;
  for (std::size_t f = 0; f < placement.footings.size(); ++f) {
    if (placement.footings[f].leg >= 0) continue;  // a foot stays where it is
    placement.T_ref_footing[f] = placement.T_ref_footing[f] * T_root_new;
  }
}

/// Removes parameters that are nominal by definition from the posterior.
void Hold(const std::vector<int>& held, CalibrationResult& result) {
  Posterior& posterior = result.posterior;
  std::vector<int> left, positions;
  for (std::size_t k = 0; k < posterior.parameters.size(); ++k) {
    if (std::binary_search(held.begin(), held.end(), posterior.parameters[k])) continue;
    left.push_back(posterior.parameters[k]);
    positions.push_back(static_cast<int>(k));
  }
  posterior.covariance = Eigen::MatrixXd(posterior.covariance(positions, positions));
  posterior.data_information = Eigen::MatrixXd(posterior.data_information(positions, positions));
  posterior.parameters = std::move(left);
  for (int i : held) {
    result.delta[i] = 0.0;
    result.sd[i] = result.prior_sd[i] = std::numeric_limits<double>::quiet_NaN();
    result.status[i] = ParameterStatus::kHeld;
  }
}

}  // namespace

Eigen::VectorXd DisplaceRoot(const ErrorModel& model, const Eigen::VectorXd& delta,
                             const Transform& T_root_new) {
  const Geometry geometry = ApplyErrors(model, delta);
  const Transform T_new_root = T_root_new.inverse();
  Eigen::VectorXd displaced = delta;
  const SixConstants waist(model.T_ref_waist.inverse() * WaistPose(geometry) * T_root_new *
                           RotX(0.5 * M_PI));
  displaced.head<kWaistParameterCount>() << waist.gamma, waist.b, waist.alpha - 0.5 * M_PI, waist.d,
      waist.theta, waist.r;
  for (int i = 0; i < model.parameter_count(); ++i) {
    const Parameter& parameter = model.parameters[i];
    if (!PlacesOnRoot(model, parameter)) continue;
    const JointPlacement& nominal = model.placements[parameter.joint];
    const SixConstants now(nominal.T_parent_pre.inverse() * T_new_root *
                           JointInRoot(geometry, parameter.joint));
    displaced[i] = ConstantError(parameter.kind, now, nominal);
  }
  for (int m = 0, i = model.parameter_count() - 3 * model.marker_count(); m < model.marker_count();
       ++m, i += 3) {
    const Marker& marker = model.markers[m];
    const Link& link = model.tree.links[marker.link];
    if (link.body != 0) continue;
    displaced.segment<3>(i) =
        link.T_body_link.inverse() * (T_new_root * geometry.p_joint_marker[m]) -
        marker.p_link_marker;
  }
  return displaced;
}

Transform FindRootDisplacement(const Gauge& gauge, const ErrorModel& model,
                               const Eigen::VectorXd& delta) {
  if (gauge.rule == GaugeRule::kPrior) return Transform::Identity();
  const Geometry geometry = ApplyErrors(model, delta);
  if (gauge.rule == GaugeRule::kLink) {
    const int joint = JointOfLink(model, gauge.link);
    return JointInRoot(geometry, joint) * NominalInRoot(model, joint).inverse();
  }
  const Eigen::Matrix3Xd nominal = MarkersOnBody(model, 0);
  Eigen::Matrix3Xd estimated(3, nominal.cols());
  Eigen::Index count = 0;
  for (int m = 0; m < model.marker_count(); ++m) {
    if (model.tree.links[model.markers[m].link].body != 0) continue;
    estimated.col(count++) = geometry.p_joint_marker[m];
  }
  return FitRigid(nominal, estimated);
}

void CheckGauge(const Gauge& gauge, const ErrorModel& model, const BaseParameters& base) {
  if (gauge.rule == GaugeRule::kPrior) return;
  const std::string place = "calibration.gauge: " + GaugeText(gauge) + ": ";
  if (gauge.rule == GaugeRule::kNominalMarkers && !TellPose(MarkersOnBody(model, 0))) {
    throw InputError(place +
                     "three or more recorded markers on the root link that do not lie on a line "
                     "were expected");
  }
  if (gauge.rule == GaugeRule::kLink && JointOfLink(model, gauge.link) < 0) {
    throw InputError(place + "the recording shows nothing that this link carries");
  }
  for (const Linkage& linkage : model.tree.linkages) {
    if (!OnRoot(model, linkage.joints.front())) continue;
    throw InputError(place + "linkage '" + linkage.name +
                     "' has its motors on the root link, whose frame they fix; prior was expected");
  }
  for (int i : base.held) {
    if (!PlacesOnRoot(model, model.parameters[i])) continue;
    throw InputError(place + "identifiability.hold holds " + model.parameters[i].name +
                     ", which changes with the root's frame");
  }
}

void ApplyGauge(const Gauge& gauge, const CalibrationOptions& options, CalibrationResult& result,
                const Transform* displacement) {
  if (gauge.rule == GaugeRule::kPrior) return;
  const ErrorModel& model = result.model;
  const Eigen::VectorXd before = result.delta;
  const Transform T_root_new =
      displacement != nullptr ? *displacement : FindRootDisplacement(gauge, model, before);
  const ErrorMap to_gauge = [&](const Eigen::VectorXd& delta) {
    return DisplaceRoot(
        model, delta,
        displacement != nullptr ? *displacement : FindRootDisplacement(gauge, model, delta));
  };
  const ErrorMap back = [&](const Eigen::VectorXd& delta) {
    return DisplaceRoot(model, delta, T_root_new.inverse());
  };
  Posterior& posterior = result.posterior;
  const std::vector<int> displaced = DisplacedErrors(model);
  const Eigen::MatrixXd A = GaugeDerivative(to_gauge, before, displaced, posterior.parameters);
  Eigen::VectorXd after = to_gauge(before);
  if (!result.placement.empty()) {  // T0 is none of its parameters
    after.head<kWaistParameterCount>() = before.head<kWaistParameterCount>();
    DisplacePlacement(T_root_new, result.placement);
  }
  const Eigen::MatrixXd B = GaugeDerivative(back, after, displaced, posterior.parameters);
  result.delta = std::move(after);
  posterior.covariance = A * posterior.covariance * A.transpose();
  posterior.data_information = B.transpose() * posterior.data_information * B;
  result.gauge = gauge;
  if (gauge.rule == GaugeRule::kLink) {
    const int joint = JointOfLink(model, gauge.link);
    std::vector<int> held;
    for (int i : displaced) {
      if (model.parameters[i].joint == joint) held.push_back(i);
    }
    Hold(held, result);
  }
  result.sd(posterior.parameters) = posterior.StandardDeviations();
  for (int i : posterior.parameters) {
    const bool told = result.sd[i] < options.support_threshold * result.prior_sd[i];
    result.status[i] = told ? ParameterStatus::kEstimated : ParameterStatus::kUnsupported;
  }
  result.correlations = StrongCorrelations(posterior, options.correlation_threshold);
}

}  // namespace elastocal
