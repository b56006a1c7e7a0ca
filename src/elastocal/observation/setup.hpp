// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "elastocal/observation/camera.hpp"
#include "elastocal/observation/flush_contact.hpp"
#include "elastocal/observation/instrument.hpp"

namespace elastocal {

/// A foot that stands on the floor without moving in every posture.
struct ContactFoot {
  int link = 0;
  /// Pose of the foot. The floor's frame is that of the first foot, z up.
  Transform T_floor_foot = Transform::Identity();
  double share = 0.5;  ///< share of the weight
};

/// A plate of the robot and the table that it touches; each plate has its own table.
struct ContactPlate {
  std::string name;
  int link = 0;
  PlateFace face = {};
};

/// How a robot stands, and what observes it. Instruments, quantities and sources are added by the
/// functions below.
struct ObservationSetup {
  /// Empty: the root link is held still, level except for a small unknown tilt, and its frame is
  /// the floor's frame.
  std::vector<ContactFoot> feet = {};
  std::vector<ContactPlate> plates = {};  ///< the first instruments
  std::vector<std::shared_ptr<const Instrument>> instruments = {};
  std::vector<Quantity> quantities = {};
  std::vector<Source> sources = CommonSources();
  /// Patterns of parameters with one value in common, such as the compliance of both hips.
  std::vector<std::vector<std::string>> common = {};
  std::vector<std::string> hold = {};  ///< patterns of parameters that stay nominal
  /// Probability that an outlier is named in postures without any.
  double outlier_probability = 0.01;
};

/// Adds a source and returns its index.
int AddSource(ObservationSetup& setup, Source source);

/// Adds a quantity and returns its index.
int AddQuantity(ObservationSetup& setup, Quantity quantity);

/// Adds a plate that touches a table flush (FlushContact). Throws std::invalid_argument if other
/// instruments were added before.
void AddPlate(ObservationSetup& setup, const ContactPlate& plate);

/// In the descriptions below, `link` carries what is observed, `p_link` or `T_link` is nominal and
/// uncertain by `mounting_sd`, and `noise_sd` is a first guess (the data decide).

/// Adds the plane of a table, of a wall or of a gauge's reference, and returns the index of its
/// quantity. Its normal is nominally `normal` with the uncertainty of a table (kTableTilt); its
/// place is unknown.
int AddPlane(ObservationSetup& setup, const std::string& name,
             const Eigen::Vector3d& normal = Eigen::Vector3d::UnitZ());

struct PlaneDistanceSetup {
  std::string name;
  int link = 0;
  Eigen::Vector3d p_link = Eigen::Vector3d::Zero();  ///< m
  int plane = 0;                                     ///< index of the quantity, see AddPlane
  double mounting_sd = 1e-3;                         ///< m
  double noise_sd = 1e-3;                            ///< m
};
void AddPlaneDistance(ObservationSetup& setup, const PlaneDistanceSetup& of);

/// A tracker at an unknown place. `carrier` is the link that carries it; -1: it stands on the
/// floor.
struct Tracker {
  int quantity = 0, carrier = -1;
};
Tracker AddTracker(ObservationSetup& setup, const std::string& name, int carrier = -1);

struct TrackedPointSetup {
  std::string name;
  int link = 0;
  Eigen::Vector3d p_link = Eigen::Vector3d::Zero();  ///< m
  Tracker tracker = {};
  double mounting_sd = 0.0;  ///< m; 0: unknown (1 m)
  double noise_sd = 1e-3;    ///< m
  int noise = -1;            ///< index of a source that several have in common; -1: its own
};
void AddTrackedPoint(ObservationSetup& setup, const TrackedPointSetup& of);

struct TrackedBodySetup {
  std::string name;
  int link = 0;
  Transform T_link = Transform::Identity();
  Tracker tracker = {};
  double mounting_sd_m = 0.0, mounting_sd_rad = 0.0;  ///< 0: unknown (1 m, 1 rad)
  double position_sd = 1e-3, rotation_sd = 2e-3;      ///< noise, m and rad
  /// Covariance of position [m] and rotation vector [rad] in the order and axes of TrackedBody, up
  /// to a factor, which the data decide. Empty: position and rotation have a standard deviation
  /// each.
  Eigen::MatrixXd covariance = {};
};
/// Throws std::invalid_argument for a covariance that is not positive definite.
void AddTrackedBody(ObservationSetup& setup, const TrackedBodySetup& of);

struct InertialUnitSetup {
  std::string name;
  int link = 0;
  Eigen::Matrix3d R_link_unit = Eigen::Matrix3d::Identity();
  double mounting_sd = 0.0;  ///< rad; 0: unknown (1 rad)
  double bias_sd = 0.02;     ///< m/s^2
  double scale_sd = 5e-3;
  double noise_sd = 0.02;  ///< m/s^2
};
void AddInertialUnit(ObservationSetup& setup, const InertialUnitSetup& of);

struct WireSetup {
  std::string name;
  int link = 0;
  Eigen::Vector3d p_link = Eigen::Vector3d::Zero();  ///< m
  /// Approximate position of the fixed point, m.
  Eigen::Vector3d p_floor = Eigen::Vector3d::Zero();
  double anchor_sd = 0.1, zero_sd = 0.01;  ///< m
  double mounting_sd = 1e-3;               ///< m
  double noise_sd = 1e-3;                  ///< m
};
void AddWire(ObservationSetup& setup, const WireSetup& of);

/// A camera on a link, or on the floor (`link` -1).
struct CameraSetup {
  std::string name;
  int link = -1;
  Transform T_parent = Transform::Identity();  ///< nominal pose of the camera
  Camera camera = {};
  double mounting_sd_m = 0.05, mounting_sd_rad = 0.1;
  double focal_sd = 0.01, centre_sd = 0.01;  ///< relative to the focal lengths
  double distortion_sd = 0.02;
  double noise_sd = 0.5;  ///< px
};
struct MountedCamera {
  CameraSetup of;
  int pose = 0, numbers = 0;  ///< indices of quantities
  /// Sources of noise: `noise` of a corner relative to the others of its tag; `shared` of all
  /// corners of a tag in one image, where errors of the robot show that no model describes.
  int noise = 0, shared = 0;
};
MountedCamera AddCamera(ObservationSetup& setup, const CameraSetup& of);

/// A square tag on a link, or on the floor (`link` -1). Its x axis points to the right, y up, z out
/// of the tag.
struct TagSetup {
  std::string name;
  int link = -1;
  Transform T_parent = Transform::Identity();  ///< nominal pose of the tag's centre
  double size = 0.05;                          ///< edge between the corners, m
  double mounting_sd_m = 0.05, mounting_sd_rad = 0.1;
};
struct MountedTag {
  TagSetup of;
  int pose = 0;  ///< index of the quantity
};
MountedTag AddTag(ObservationSetup& setup, const TagSetup& of);

/// Adds the observation of the tag by the camera: an instrument named "camera/tag".
void AddSeenTag(ObservationSetup& setup, const MountedCamera& camera, const MountedTag& tag);

}  // namespace elastocal
