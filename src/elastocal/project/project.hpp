// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/calibration/options.hpp"
#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/measurement/reference_scale.hpp"
#include "elastocal/measurement/trial_samples.hpp"
#include "elastocal/observation/setup.hpp"
#include "elastocal/robot/error_model.hpp"
#include "elastocal/robot/motion_setup.hpp"
#include "elastocal/robot/standing.hpp"

namespace elastocal {

/// A chain of the robot, from a link (default: the waist) to a tip link.
struct Chain {
  std::string name;
  int from_link = 0, tip_link = 0;
};

/// Three (or more) markers on one link that are seen together.
struct MarkerCluster {
  std::string name;
  int link = 0;
  std::vector<int> markers;  ///< indices into Project::markers
};

/// Names of columns and labels in recordings, where they differ from the names in the robot
/// description and the project, and what recordings do not say by themselves.
struct RecordingColumns {
  std::string time = "t";                     ///< optional in the file
  std::map<std::string, std::string> joints;  ///< joint -> column; default: the joint's name
  std::map<std::string, std::array<std::string, 3>> markers;  ///< marker -> NAME_x, NAME_y, NAME_z
  std::vector<std::string> ignore;                            ///< columns that are not read
  /// Posture table: whether the root link has another pose in each posture. If not, markers are
  /// measured in a frame fixed to it.
  bool free_root = false;
  Eigen::Vector3d gravity = GravityBelow("z");  ///< of a posture table, as Recording::gravity
  /// Joint -> position [rad or m] that it has if the file holds none.
  std::map<std::string, double> not_recorded;
  /// Marker -> its label in files of cameras; default: the marker's name.
  std::map<std::string, std::string> labels = {};
  /// Known lengths by which the scale of the cameras is checked in each trial.
  std::vector<ReferenceLength> reference_lengths = {};
};

/// Which parts of the robot are estimated as elastic (eq. 5 to 7). If patterns are not given, none
/// are for a posture table. For a recording of trials, all joints are elastic about their axes, and
/// those that twist and those of the legs, which carry the robot, also across them.
struct ElasticityChoice {
  std::optional<std::vector<std::string>> torsion = {};  ///< joints elastic about their axes
  std::optional<std::vector<std::string>> bending = {};  ///< joints elastic across their axes too
  /// Whether the root link bends up to the joints on it that bend, in recordings of trials.
  bool root_bending = true;
  bool base = true;          ///< legs that stand alone in a trial: lumped compliance, eq. 6
  bool torque_bias = false;  ///< biases of the torque sensors of these legs
  /// Causes beyond springs that the model has (chosen as `calibration.extra` says), and the mean
  /// time of the postures, h, if they have times.
  std::vector<std::string> extra = {};
  std::optional<double> hours = {};
};

/// How the touches of one session are told from those of another. By default each file is one
/// session.
struct SessionRule {
  /// Whether the encoders tell the starts of the robot (FindEncoderStarts), each of which is a
  /// session. Unset: they only give a proposal.
  std::optional<bool> from_encoders = {};
  /// Columns of a touch table; touches with the same texts in all of them are of one session.
  std::vector<std::string> columns;
  /// If above 0, the columns are numbers, and round(number / quantum) modulo `modulo` names the
  /// session.
  double quantum = 0.0;
  std::int64_t modulo = 0;
};

/// The view of a tag by a camera of the project, which is an instrument.
struct TagInCamera {
  std::string camera, tag;
  int instrument = 0;
};

/// The level top of a table that a plate touches. Its sides are along x and y of the floor's frame.
struct TableTop {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< m, on the floor
  Eigen::Vector2d size = Eigen::Vector2d::Zero();    ///< m
};

/// Observations of a robot other than by markers alone: it touches tables, or instruments measure
/// it.
struct ContactProject {
  ObservationSetup setup;         ///< as far as the project gives it, see PlaceFeet
  std::vector<char> foot_placed;  ///< for each foot, whether the project says where it stands
  std::vector<std::optional<TableTop>> tables;  ///< by plate, for postures to be designed
  std::string plate_column;  ///< names the plate of each touch; empty: see FindTouchingPlates
  SessionRule sessions;
  /// Columns of a table for each instrument of the setup; empty for plates and tags.
  std::vector<std::vector<std::string>> columns;
  std::vector<TagInCamera> seen_tags;  ///< in tables of corners, see ReadDetections
};

/// Contents of a project file, checked and in SI units.
struct Project {
  std::filesystem::path file, urdf;
  RobotTree tree;
  std::vector<Chain> chains;
  std::vector<Marker> markers;
  std::vector<MarkerCluster> clusters;
  std::string reference_cluster;    ///< cluster on the waist; empty: none
  std::vector<int> torque_sensors;  ///< joints
  std::vector<ForceTorqueSensor> force_torque_sensors;
  RecordingColumns recording;
  PlacementOptions placement;
  MeasurementOptions measurement;
  IdentifiabilityOptions identifiability;
  CalibrationOptions calibration;
  ElasticityChoice elasticity;
  std::vector<Sole> soles;  ///< soles on which the robot can stand; none: standing is not planned
  /// Distance between the centres of two soles on which it stands, m; default: as in the zero
  /// posture.
  std::optional<double> stance;
  std::optional<ContactProject> contact;  ///< recordings are tables of touches and instruments
  MotionSetup motion;                     ///< what the calibration postures and motions keep to
};

/// Reads a project file and the URDF that it names (docs/formats.md).
/// Throws InputError naming file, line and key: missing file, malformed YAML or URDF, unknown key
/// (with the nearest known one), wrong type, unknown link or joint, value out of range.
Project ReadProject(const std::filesystem::path& file);

/// The same from the text of the file; paths in it are seen from the folder of `file`.
Project ParseProject(const std::string& text, const std::filesystem::path& file);

/// The error model of the project's robot for a recording of these trials; no trials: for a posture
/// table. Legs are the chains on whose tip alone a trial stands.
ErrorModel MakeProjectModel(const Project& project, const std::vector<Trial>& trials);

/// Joints whose names match any of the patterns, ascending.
std::vector<int> MatchingJoints(const RobotTree& tree, const std::vector<std::string>& patterns);

/// Throws InputError for a project without markers, whose recordings are touches: only `calibrate`,
/// `validate`, `compare` and `report` can use it.
void CheckHasMarkers(const Project& project);

/// Throws InputError for a project with linkages, which `what` ("the command plan") does not
/// support.
void CheckHasNoLinkages(const Project& project, const std::string& what);

/// Index of a chain of the project. Throws InputError with the nearest known name for an unknown
/// one.
int FindChain(const Project& project, const std::string& name);

/// Index of a cluster of markers. Throws InputError for an unknown one.
int FindCluster(const Project& project, const std::string& name);

/// The project's clusters, and those that single markers on the same link form: they keep their
/// distances as well. These have the name of the link, made unlike those of the others.
std::vector<MarkerCluster> RigidClusters(const Project& project);

/// Markers carried by the links of a chain, beyond its `from` link up to and including its tip.
std::vector<std::string> ChainMarkers(const Project& project, const Chain& chain);

}  // namespace elastocal
