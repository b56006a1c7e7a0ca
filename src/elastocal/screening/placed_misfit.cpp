// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/placed_misfit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

constexpr int kMostPlaced = 60;
constexpr int kTurns = 8;     // rounds of placing root and markers in turn
constexpr double kFar = 5.0;  // times the median distance

struct Sighting {
  int posture = 0, marker = 0;
  Eigen::Vector3d measured;
  bool left_out = false;  ///< left out when the root is placed
};

ErrorModel AtOrigin(ErrorModel model) {
  model.T_ref_waist = Transform::Identity();
  return model;
}

Geometry GeometryBy(const ErrorModel& model, const Eigen::VectorXd* errors) {
  if (errors != nullptr) return ApplyErrors(model, *errors);
  return ApplyErrors(model, Eigen::VectorXd::Zero(model.parameter_count()));
}

/// The nominal robot, placed among the measured markers.
class PlacedRobot {
 public:
  PlacedRobot(const ErrorModel& model, const Recording& recording,
              const Eigen::VectorXd* errors = nullptr)
      : free_root_(recording.free_root) {
    const ErrorModel at_origin = AtOrigin(model);
    const Geometry geometry = GeometryBy(at_origin, errors);
    const int stride = 1 + (recording.posture_count() - 1) / kMostPlaced;
    for (int i = 0; i < recording.posture_count(); i += stride) {
      InterruptionPoint();
      const auto posture = static_cast<int>(bodies_.size());
      bodies_.push_back(BodyTransforms(at_origin, geometry, recording.q.row(i).transpose()));
      for (int m = 0; m < recording.marker_count(); ++m) {
        if (Seen(recording, i, m)) {
          sightings_.push_back({posture, m, MarkerPosition(recording, i, m)});
        }
      }
    }
    for (const Marker& marker : model.markers) {
      const Link& link = model.tree.links[Size(marker.link)];
      body_.push_back(link.body);
      places_.emplace_back(link.T_body_link * marker.p_link_marker);
    }
  }

  void Place() {
    for (int turn = 0; turn < kTurns; ++turn) {
      PlaceRoot();
      PlaceMarkers();
      LeaveOutFarSightings();
    }
  }

  const std::optional<Transform>& root() const { return roots_.front(); }
  const std::vector<Eigen::Vector3d>& places() const { return places_; }

  double Misfit() {
    Place();
    std::vector<std::vector<double>> distances(places_.size());
    for (const Sighting& one : sightings_) {
      if (const auto distance = DistanceOf(one)) distances[Size(one.marker)].push_back(*distance);
    }
    return TypicalDistance(distances);
  }

 private:
  const Transform& BodyOf(const Sighting& one) const {
    return bodies_[Size(one.posture)][Size(body_[Size(one.marker)])];
  }
  Eigen::Vector3d InRoot(const Sighting& one) const {
    return BodyOf(one) * places_[Size(one.marker)];
  }

  /// Distance of a measured marker from its predicted position, m; nothing where its root is not
  /// placed.
  std::optional<double> DistanceOf(const Sighting& one) const {
    const auto& root = roots_[Size(one.posture)];
    if (!root) return std::nullopt;
    return (*root * InRoot(one) - one.measured).norm();
  }

  void LeaveOutFarSightings() {
    std::vector<double> distances;
    for (const Sighting& one : sightings_) {
      if (const auto distance = DistanceOf(one)) distances.push_back(*distance);
    }
    const double far = kFar * Median(distances);
    for (Sighting& one : sightings_) one.left_out = DistanceOf(one).value_or(0.0) > far;
  }

  void PlaceRoot() {
    const std::size_t groups = free_root_ ? bodies_.size() : 1;
    std::vector<std::vector<Eigen::Vector3d>> nominal(groups), measured(groups);
    for (const Sighting& one : sightings_) {
      if (one.left_out) continue;
      const std::size_t group = free_root_ ? Size(one.posture) : 0;
      nominal[group].push_back(InRoot(one));
      measured[group].push_back(one.measured);
    }
    std::vector<std::optional<Transform>> placed;
    for (std::size_t group = 0; group < groups; ++group) {
      placed.push_back(FitRigid(nominal[group], measured[group]));
    }
    roots_ = free_root_ ? std::move(placed)
                        : std::vector<std::optional<Transform>>(bodies_.size(), placed.front());
  }

  /// Places each marker where most observations have it on its link.
  void PlaceMarkers() {
    std::vector<std::vector<double>> seen(3 * places_.size());
    for (const Sighting& one : sightings_) {
      const auto& root = roots_[Size(one.posture)];
      if (!root) continue;
      const Eigen::Vector3d place = BodyOf(one).inverse() * (root->inverse() * one.measured);
      for (int axis = 0; axis < 3; ++axis) seen[Size(3 * one.marker + axis)].push_back(place[axis]);
    }
    for (std::size_t k = 0; k < seen.size(); ++k) {
      if (!seen[k].empty()) places_[k / 3][static_cast<Eigen::Index>(k % 3)] = Median(seen[k]);
    }
  }

  bool free_root_;
  std::vector<std::vector<Transform>> bodies_;  ///< poses in the root link's frame, by posture
  std::vector<Sighting> sightings_;
  std::vector<int> body_;                        ///< by marker
  std::vector<Eigen::Vector3d> places_;          ///< of the markers, in their bodies' frames
  std::vector<std::optional<Transform>> roots_;  ///< by posture
};

}  // namespace

double TypicalDistance(const std::vector<std::vector<double>>& by_marker) {
  double squares = 0.0;
  int count = 0;
  for (const std::vector<double>& of_marker : by_marker) {
    if (of_marker.empty()) continue;
    squares += std::pow(Median(of_marker), 2);
    ++count;
  }
  return count == 0 ? 0.0 : std::sqrt(squares / count);
}

double PlacedNominal::Distance(const Recording& recording, int posture) const {
  const std::vector<Transform> bodies =
      BodyTransforms(model, geometry, recording.q.row(posture).transpose());
  double squares = 0.0, furthest = 0.0;
  int count = 0;
  for (int m = 0; m < recording.marker_count(); ++m) {
    if (!Seen(recording, posture, m)) continue;
    const int body = model.tree.links[Size(model.markers[Size(m)].link)].body;
    const Eigen::Vector3d at = T_ref_root * (bodies[Size(body)] * places[Size(m)]);
    const double square = (at - MarkerPosition(recording, posture, m)).squaredNorm();
    squares += square;
    furthest = std::max(furthest, square);
    ++count;
  }
  return count < 2 ? std::sqrt(squares) : std::sqrt((squares - furthest) / (count - 1));
}

std::optional<PlacedNominal> PlaceNominal(const ErrorModel& model, const Recording& recording,
                                          const Eigen::VectorXd* errors) {
  PlacedRobot robot(model, recording, errors);
  robot.Place();
  if (!robot.root()) return std::nullopt;
  PlacedNominal placed{AtOrigin(model), {}, *robot.root(), robot.places()};
  placed.geometry = GeometryBy(placed.model, errors);
  return placed;
}

double PlacedMisfit(const ErrorModel& model, const Recording& recording) {
  return PlacedRobot(model, recording).Misfit();
}

}  // namespace elastocal
