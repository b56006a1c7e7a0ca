// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/sole_springs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "elastocal/math/statistics.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {
namespace {

constexpr double kStaysWithin = 0.3e-3;            // m
constexpr double kSinksLess = 5e-3;                // m: more means that the foot was lifted
constexpr double kTurnsLess = 0.3 * M_PI / 180.0;  // rad
constexpr double kLeastChange = 0.2;               // share of the weight: less is no change of load
constexpr double kLoadShare = 0.05;                // relative uncertainty of the loads

/// Estimated positions of the markers in the link of their foot, m, one a column; NaN for markers
/// that the estimate does not have.
Eigen::Matrix3Xd PlacesInLink(const CalibrationResult& result, const Geometry& geometry, int link,
                              const std::vector<std::string>& markers) {
  Eigen::Matrix3Xd places =
      Eigen::Matrix3Xd::Constant(3, static_cast<Eigen::Index>(markers.size()), NAN);
  for (std::size_t k = 0; k < markers.size(); ++k) {
    const auto marker = std::ranges::find(result.model.markers, markers[k], &Marker::name);
    if (marker == result.model.markers.end()) continue;
    const auto m = static_cast<int>(marker - result.model.markers.begin());
    places.col(static_cast<Eigen::Index>(k)) =
        PlaceMarker(result.model, geometry, m, link).position;
  }
  return places;
}

/// Motion of a foot: displacement of its link's origin, m, and angle, rad.
struct FootMotion {
  Eigen::Vector3d shift;
  double turn = 0.0;
};

/// Motion of a foot by the markers (columns) that were seen both times. Nothing where these do not
/// determine a pose, or have moved relative to each other.
std::optional<FootMotion> MotionBetween(const Eigen::Matrix3Xd& in_link,
                                        const Eigen::Matrix3Xd& before,
                                        const Eigen::Matrix3Xd& after) {
  std::vector<Eigen::Index> seen;
  for (Eigen::Index k = 0; k < in_link.cols(); ++k) {
    if ((in_link.col(k) + before.col(k) + after.col(k)).allFinite()) seen.push_back(k);
  }
  const Eigen::Matrix3Xd places = in_link(Eigen::all, seen), from = before(Eigen::all, seen),
                         to = after(Eigen::all, seen);
  if (seen.size() < 3 || !TellPose(places)) return std::nullopt;
  const Transform T_after_before = FitRigid(from, to);
  const double bent = (T_after_before * from - to).colwise().norm().maxCoeff();
  if (bent > kStaysWithin) return std::nullopt;
  const Eigen::Vector3d origin = FitRigid(places, from).translation();
  return FootMotion{T_after_before * origin - origin, RotationAngle(T_after_before.linear())};
}

bool StaysWithin(const FootMotion& motion, const Eigen::Vector3d& up) {
  const Eigen::Vector3d along = motion.shift - up.dot(motion.shift) * up;
  return along.norm() < kStaysWithin && std::abs(up.dot(motion.shift)) < kSinksLess &&
         motion.turn < kTurnsLess;
}

/// A foot that stays in place over several trials: its motion since the first of them, by trial.
struct Stay {
  std::vector<Eigen::Vector3d> shift;  ///< along two directions of the floor, then up, m
  std::vector<double> share;           ///< load as share of the weight
};

/// The stays of one foot.
std::vector<Stay> FindStays(const CalibrationResult& result, const std::vector<FootRest>& rests,
                            const Eigen::Vector3d& up, int link) {
  const Geometry geometry = ApplyErrors(result.model, result.delta);
  Eigen::Matrix3d axes;
  axes << up.unitOrthogonal().transpose(), up.cross(up.unitOrthogonal()).transpose(),
      up.transpose();
  std::vector<Stay> stays;
  const FootRest* begin = nullptr;   // first trial of the stay
  const FootRest* before = nullptr;  // the trial before this one
  for (const FootRest& rest : rests) {
    if (rest.link != link) continue;
    const Eigen::Matrix3Xd places = PlacesInLink(result, geometry, link, rest.markers);
    const auto within = MotionBetween(places, rest.at_first, rest.at_last);
    const bool follows =
        before != nullptr && before->session == rest.session && before->trial + 1 == rest.trial;
    before = &rest;
    if (!within || !StaysWithin(*within, up) || !std::isfinite(rest.share)) {
      begin = nullptr;
      continue;
    }
    std::optional<FootMotion> motion;
    if (follows && begin != nullptr) motion = MotionBetween(places, begin->at, rest.at);
    if (!motion || !StaysWithin(*motion, up)) {
      begin = &rest;
      stays.push_back({});
      motion = FootMotion{Eigen::Vector3d::Zero()};
    }
    stays.back().shift.emplace_back(axes * motion->shift);
    stays.back().share.push_back(rest.share);
  }
  return stays;
}

double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Sums of squares over the stays of a foot, about the mean of each stay.
struct Sums {
  /// squares of the load (as share of the weight), products with height, squares of height; m
  double loads = 0.0, sinking = 0.0, heights = 0.0;
  double along = 0.0;   ///< along both directions of the floor, m^2
  int changes = 0;      ///< number of trials without the first of each stay
  double change = 0.0;  ///< the largest change of load in a stay, as share of the weight

  bool Loaded() const { return change > kLeastChange; }
};

Sums SumsOf(const std::vector<Stay>& stays) {
  Sums sums;
  for (const Stay& stay : stays) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& shift : stay.shift) mean += shift;
    mean /= static_cast<double>(stay.shift.size());
    const double share = Mean(stay.share);
    for (std::size_t i = 0; i < stay.share.size(); ++i) {
      const Eigen::Vector3d off = stay.shift[i] - mean;
      const double more = stay.share[i] - share;
      sums.loads += more * more;
      sums.sinking -= more * off.z();
      sums.heights += off.z() * off.z();
      sums.along += off.head<2>().squaredNorm();
    }
    sums.changes += static_cast<int>(stay.share.size()) - 1;
    const auto [least, most] = std::ranges::minmax_element(stay.share);
    sums.change = std::max(sums.change, *most - *least);
  }
  return sums;
}

}  // namespace

double SoleSpring::most() const { return std::max(0.0, compliance) + interval_factor * sd; }

std::vector<SoleSpring> EstimateSoleSprings(const CalibrationResult& result,
                                            const std::vector<FootRest>& rests,
                                            const Eigen::Vector3d& gravity) {
  const double weight = TotalMass(result.model.tree) * gravity.norm();
  std::vector<SoleSpring> springs;
  std::vector<Sums> feet;
  double squares = 0.0;
  int freedom = 0;
  for (const SupportLeg& leg : result.model.legs) {
    const Sums sums = SumsOf(FindStays(result, rests, -gravity.normalized(), leg.link));
    squares += sums.along + sums.heights;
    if (sums.Loaded()) squares -= sums.sinking * sums.sinking / sums.loads;
    freedom += 3 * sums.changes - (sums.Loaded() ? 1 : 0);
    feet.push_back(sums);
    springs.push_back({.leg = leg.name});
  }
  for (std::size_t i = 0; i < feet.size(); ++i) {
    if (!feet[i].Loaded()) continue;
    const double compliance = feet[i].sinking / feet[i].loads / weight;
    const double scatter = std::sqrt(std::max(0.0, squares) / freedom / feet[i].loads) / weight;
    const double sd = std::hypot(scatter, kLoadShare * compliance);
    if (!(std::abs(compliance) <= kSoftestSole && sd > 0.0)) continue;
    springs[i] = {springs[i].leg, feet[i].changes, compliance, sd, StudentQuantile(0.975, freedom)};
  }
  return springs;
}

}  // namespace elastocal
