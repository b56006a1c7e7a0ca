// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/setup.hpp"

#include <stdexcept>
#include <utility>

#include <Eigen/Cholesky>

#include "elastocal/math/transform.hpp"
#include "elastocal/observation/gravity_direction.hpp"
#include "elastocal/observation/plane_distance.hpp"
#include "elastocal/observation/seen_tag.hpp"
#include "elastocal/observation/tracked.hpp"
#include "elastocal/observation/wire_length.hpp"

namespace elastocal {
namespace {

using Role = Source::Role;

/// A source with standard deviation `sd`, or the unknown one where that is 0.
int PriorSource(ObservationSetup& setup, const std::string& name, SourceUnit unit, double sd) {
  if (sd <= 0.0) return unit == SourceUnit::kRadian ? kUnknownTurn : kUnknownPlace;
  return AddSource(setup, {name, unit, sd, Role::kFixed});
}

int AddNoise(ObservationSetup& setup, const std::string& name, SourceUnit unit, double sd) {
  return AddSource(setup, {name, unit, sd, Role::kNoise});
}

/// Adds the position of a point on its link.
int AddMountedPoint(ObservationSetup& setup, const std::string& name, const Eigen::Vector3d& p_link,
                    double sd) {
  Quantity point{name + ".point", {}, false};
  point.sources.assign(3, PriorSource(setup, name + ".mounting", SourceUnit::kMetre, sd));
  point.origin.translation() = p_link;
  return AddQuantity(setup, std::move(point));
}

/// Adds the pose of a frame on its link or, with `of_surroundings`, on the floor.
int AddMountedFrame(ObservationSetup& setup, const std::string& name, const Transform& nominal,
                    double sd_m, double sd_rad, bool of_surroundings) {
  Quantity mount{name + ".mounting", {}, of_surroundings};
  mount.origin = nominal;
  const int place = PriorSource(setup, name + ".mounting", SourceUnit::kMetre, sd_m);
  const int turn = PriorSource(setup, name + ".mounting_turn", SourceUnit::kRadian, sd_rad);
  mount.sources = {place, place, place, turn, turn, turn};
  return AddQuantity(setup, std::move(mount));
}

template <typename Kind>
std::shared_ptr<Kind> MakeInstrument(const std::string& name, const std::vector<int>& links,
                                     const std::vector<int>& quantities,
                                     const std::vector<int>& noise) {
  auto instrument = std::make_shared<Kind>();
  instrument->name = name;
  instrument->links = links;
  instrument->quantities = quantities;
  instrument->noise = noise;
  return instrument;
}

std::vector<int> TrackedLinks(int link, const Tracker& tracker) {
  if (tracker.carrier < 0) return {link};
  return {link, tracker.carrier};
}

}  // namespace

int AddSource(ObservationSetup& setup, Source source) {
  setup.sources.push_back(std::move(source));
  return static_cast<int>(setup.sources.size()) - 1;
}

int AddQuantity(ObservationSetup& setup, Quantity quantity) {
  setup.quantities.push_back(std::move(quantity));
  return static_cast<int>(setup.quantities.size()) - 1;
}

int AddPlane(ObservationSetup& setup, const std::string& name, const Eigen::Vector3d& normal) {
  Quantity plane{name + ".plane", {kUnknownPlace, kTableTilt, kTableTilt}, true};
  plane.origin.linear() = RotationBetween(Eigen::Vector3d::UnitZ(), normal);
  return AddQuantity(setup, std::move(plane));
}

void AddPlate(ObservationSetup& setup, const ContactPlate& plate) {
  if (setup.instruments.size() != setup.plates.size()) {
    throw std::invalid_argument("plates are the first instruments");
  }
  const int tilts = AddQuantity(setup, {plate.name + ".tilts", {kPlateTilt, kPlateTilt}, false});
  const int table = AddPlane(setup, plate.name);
  auto contact = MakeInstrument<FlushContact>(plate.name, {plate.link}, {tilts, table},
                                              {kHeight, kTilt, kTilt});
  contact->face = plate.face;
  contact->varying = 1;
  setup.plates.push_back(plate);
  setup.instruments.push_back(std::move(contact));
}

void AddPlaneDistance(ObservationSetup& setup, const PlaneDistanceSetup& of) {
  const int point = AddMountedPoint(setup, of.name, of.p_link, of.mounting_sd);
  const int noise = AddNoise(setup, of.name + ".noise", SourceUnit::kMetre, of.noise_sd);
  auto distance = MakeInstrument<PlaneDistance>(of.name, {of.link}, {of.plane, point}, {noise});
  distance->varying = 0;
  setup.instruments.push_back(std::move(distance));
}

Tracker AddTracker(ObservationSetup& setup, const std::string& name, int carrier) {
  Quantity pose{name + ".pose", {}, true, carrier < 0};
  pose.sources = {kUnknownPlace, kUnknownPlace, kUnknownPlace,
                  kUnknownTurn,  kUnknownTurn,  kUnknownTurn};
  return {AddQuantity(setup, std::move(pose)), carrier};
}

void AddTrackedPoint(ObservationSetup& setup, const TrackedPointSetup& of) {
  const int point = AddMountedPoint(setup, of.name, of.p_link, of.mounting_sd);
  const int noise = of.noise >= 0
                        ? of.noise
                        : AddNoise(setup, of.name + ".noise", SourceUnit::kMetre, of.noise_sd);
  auto tracked =
      MakeInstrument<TrackedPoint>(of.name, TrackedLinks(of.link, of.tracker),
                                   {of.tracker.quantity, point}, std::vector<int>(3, noise));
  if (of.tracker.carrier < 0) tracked->varying = 0;
  setup.instruments.push_back(std::move(tracked));
}

void AddTrackedBody(ObservationSetup& setup, const TrackedBodySetup& of) {
  const int quantity =
      AddMountedFrame(setup, of.name, of.T_link, of.mounting_sd_m, of.mounting_sd_rad, false);
  std::vector<int> noise;
  Eigen::MatrixXd whitening;
  if (of.covariance.size() > 0) {
    const Eigen::LLT<Eigen::MatrixXd> factor(of.covariance);
    if (of.covariance.rows() != 6 || factor.info() != Eigen::Success) {
      throw std::invalid_argument("the covariance of a pose is 6 x 6 and positive definite");
    }
    whitening = factor.matrixL().solve(Eigen::MatrixXd::Identity(6, 6));
    noise.assign(6, AddNoise(setup, of.name + ".noise", SourceUnit::kNone, 1.0));
  } else {
    const int p = AddNoise(setup, of.name + ".position", SourceUnit::kMetre, of.position_sd);
    const int r = AddNoise(setup, of.name + ".rotation", SourceUnit::kRadian, of.rotation_sd);
    noise = {p, p, p, r, r, r};
  }
  auto body = MakeInstrument<TrackedBody>(of.name, TrackedLinks(of.link, of.tracker),
                                          {of.tracker.quantity, quantity}, noise);
  body->whitening = std::move(whitening);
  if (of.tracker.carrier < 0) body->varying = 0;
  setup.instruments.push_back(std::move(body));
}

void AddInertialUnit(ObservationSetup& setup, const InertialUnitSetup& of) {
  Quantity unit{of.name + ".mounting", {}, false};
  unit.origin.linear() = of.R_link_unit;
  unit.sources.assign(
      3, PriorSource(setup, of.name + ".mounting", SourceUnit::kRadian, of.mounting_sd));
  const int bias =
      AddSource(setup, {of.name + ".bias", SourceUnit::kAcceleration, of.bias_sd, Role::kFixed});
  unit.sources.resize(6, bias);
  unit.sources.push_back(
      AddSource(setup, {of.name + ".scale", SourceUnit::kNone, of.scale_sd, Role::kFixed}));
  const int quantity = AddQuantity(setup, std::move(unit));
  const int noise = AddNoise(setup, of.name + ".noise", SourceUnit::kAcceleration, of.noise_sd);
  setup.instruments.push_back(
      MakeInstrument<GravityDirection>(of.name, {of.link}, {quantity}, std::vector<int>(3, noise)));
}

void AddWire(ObservationSetup& setup, const WireSetup& of) {
  Quantity anchor{of.name + ".anchor", {}, true, true};
  anchor.sources.assign(
      3, AddSource(setup, {of.name + ".anchor", SourceUnit::kMetre, of.anchor_sd, Role::kFixed}));
  anchor.sources.push_back(
      AddSource(setup, {of.name + ".zero", SourceUnit::kMetre, of.zero_sd, Role::kFixed}));
  anchor.origin.translation() = of.p_floor;
  const int fixed = AddQuantity(setup, std::move(anchor));
  const int point = AddMountedPoint(setup, of.name, of.p_link, of.mounting_sd);
  const int noise = AddNoise(setup, of.name + ".noise", SourceUnit::kMetre, of.noise_sd);
  auto wire = MakeInstrument<WireLength>(of.name, {of.link}, {fixed, point}, {noise});
  wire->varying = 0;
  setup.instruments.push_back(std::move(wire));
}

MountedCamera AddCamera(ObservationSetup& setup, const CameraSetup& of) {
  MountedCamera camera{of};
  camera.pose = AddMountedFrame(setup, of.name, of.T_parent, of.mounting_sd_m, of.mounting_sd_rad,
                                of.link < 0);
  Quantity numbers{of.name + ".numbers", {}, false};
  const auto source = [&](const char* name, double sd) {
    return AddSource(setup, {of.name + name, SourceUnit::kNone, sd, Role::kFixed});
  };
  numbers.sources.assign(2, source(".focal", of.focal_sd));
  numbers.sources.resize(4, source(".centre", of.centre_sd));
  numbers.sources.resize(Camera::kNumbers, source(".distortion", of.distortion_sd));
  camera.numbers = AddQuantity(setup, std::move(numbers));
  camera.noise = AddNoise(setup, of.name + ".noise", SourceUnit::kPixel, of.noise_sd);
  camera.shared = AddNoise(setup, of.name + ".shared", SourceUnit::kPixel, of.noise_sd);
  return camera;
}

MountedTag AddTag(ObservationSetup& setup, const TagSetup& of) {
  return {of, AddMountedFrame(setup, of.name, of.T_parent, of.mounting_sd_m, of.mounting_sd_rad,
                              of.link < 0)};
}

namespace {

/// Orthonormal combinations of the corners' u, v (8 x 8): twice their means, then their
/// differences.
Eigen::MatrixXd MeanAndRest() {
  Eigen::Matrix4d of_corners;
  of_corners << 1, 1, 1, 1,  //
      1, -1, 1, -1,          //
      1, 1, -1, -1,          //
      1, -1, -1, 1;
  Eigen::MatrixXd Q = Eigen::MatrixXd::Zero(8, 8);
  for (int i = 0; i < 4; ++i) {
    for (int corner = 0; corner < 4; ++corner) {
      Q(2 * i, 2 * corner) = Q(2 * i + 1, 2 * corner + 1) = 0.5 * of_corners(i, corner);
    }
  }
  return Q;
}

}  // namespace

void AddSeenTag(ObservationSetup& setup, const MountedCamera& camera, const MountedTag& tag) {
  std::vector<int> links;
  if (camera.of.link >= 0) links.push_back(camera.of.link);
  if (tag.of.link >= 0) links.push_back(tag.of.link);
  std::vector<int> noise(8, camera.noise);
  noise[0] = noise[1] = camera.shared;
  auto seen = MakeInstrument<SeenTag>(camera.of.name + "/" + tag.of.name, links,
                                      {camera.pose, tag.pose, camera.numbers}, noise);
  seen->whitening = MeanAndRest();
  seen->camera = camera.of.camera;
  seen->camera_carried = camera.of.link >= 0;
  seen->tag_carried = tag.of.link >= 0;
  const double half = 0.5 * tag.of.size;
  seen->p_tag_corner << -half, half, half, -half,  //
      -half, -half, half, half,                    //
      0.0, 0.0, 0.0, 0.0;
  setup.instruments.push_back(std::move(seen));
}

}  // namespace elastocal
