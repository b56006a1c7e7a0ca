// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>

#include "elastocal/files/yaml_value.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {

/// Readers of the sections of a project file, in the order in which they are called. Each reads the
/// section of its name into `project` and needs the sections before it. All throw InputError naming
/// file, line and key.
void ReadCouplings(const YamlValue& section, Project& project);
void ReadLinkages(const YamlValue& section, Project& project);
void ReadMarkers(const YamlValue& section, Project& project);
void ReadTorqueSensors(const YamlValue& section, Project& project);
void ReadForceTorqueSensors(const YamlValue& section, Project& project);
void ReadRecordingColumns(const YamlValue& section, Project& project);
void ReadPlacementOptions(const YamlValue& section, PlacementOptions& options);
void ReadMeasurementOptions(const YamlValue& section, MeasurementOptions& options);
void ReadIdentifiabilityOptions(const YamlValue& section, IdentifiabilityOptions& options);
void ReadElasticity(const YamlValue& section, Project& project);
void ReadStanding(const YamlValue& section, Project& project);
/// SetMotionDefaults sets the limits of all joints and the posture of rest, which `design` and
/// `plan` need. ReadCollision then reads the spheres, and ReadDesign the section `design`.
void SetMotionDefaults(Project& project);
void ReadCollision(const YamlValue& section, Project& project);
void ReadDesign(const YamlValue& section, Project& project);
/// Raises efforts of joints, with a warning, if gravity takes more than 80 % of them in the posture
/// of rest while the root link is held: a robot can hold its posture of rest.
void CarryRest(Project& project);
/// `instruments`: whether the project has instruments other than plates.
void ReadContact(const YamlValue& section, bool instruments, Project& project);
void ReadInstruments(const YamlValue& section, Project& project);
/// Reads the cameras and tags of the section `instruments`, and adds each camera's view of each tag
/// that can move against it.
void ReadCameras(const YamlValue& section, Project& project);
/// Adds the markers, whose columns have been read, to the instruments.
void ObserveMarkers(Project& project);
void ReadCalibrationOptions(const YamlValue& section, const RobotTree& tree,
                            CalibrationOptions& options);

constexpr double kOneDegree = M_PI / 180.0;  // rad
constexpr double kOneMm = 1e-3;              // m

constexpr std::size_t kMostInstruments = 1000;

/// The items of a list in the section `instruments`; none if the key is absent.
std::vector<YamlValue> InstrumentList(const YamlValue& section, const char* key);

/// `size` numbers of a list, each within its bounds.
Eigen::VectorXd NumbersOf(const YamlValue& list, std::size_t size);

/// Three coordinates in mm as a point in m.
Eigen::Vector3d PointFromMm(const YamlValue& value);
/// A direction of length 1 from three numbers.
Eigen::Vector3d DirectionFrom(const YamlValue& value);
/// PointFromMm of the value of a key; the origin if there is no such key.
Eigen::Vector3d OptionalPoint(const YamlValue& value, const char* key);
/// A pose [m] from the keys `xyz_mm` and `rpy_deg`, each of which may be absent.
Transform PoseFromMm(const YamlValue& value);

/// Returns what `find` returns. An InputError that it throws is thrown again as one about `value`.
template <typename Find>
auto FindNamedBy(const YamlValue& value, const Find& find) {
  try {
    return find();
  } catch (const InputError& error) {
    value.Fail(error.what());
  }
}

/// The name of a new item. Throws InputError if one of `items` has the name already. `what` says
/// what the items are.
template <typename Items>
std::string NewName(const YamlValue& name, const char* what, const Items& items) {
  for (const auto& item : items) {
    if (item.name == name.Text()) {
      name.Fail(std::string("a second ") + what + " of the name " + Quote(item.name));
    }
  }
  return name.Text();
}

/// Fails unless the text can be part of a file's name and leads to no other folder: letters,
/// digits, underscore, point and hyphen, but not only one or two points.
void CheckFileName(const YamlValue& name);

/// The link, links or movable joint that a value names.
int LinkNamedBy(const YamlValue& value, const RobotTree& tree);
std::vector<int> LinksNamedBy(const YamlValue& list, const RobotTree& tree);
int JointNamedBy(const YamlValue& value, const RobotTree& tree);
/// The joint `name`, a key whose value is `value`. It must have a position of its own, because a
/// position that follows from other joints cannot be recorded or given.
int DriverNamedBy(const std::string& name, const YamlValue& value, const RobotTree& tree);
/// The chain that a value names: index into Project::chains.
int ChainNamedBy(const YamlValue& value, const Project& project);

}  // namespace elastocal
