// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>

#include "elastocal/files/yaml_value.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {

/// Parts of a project file, in the order in which they are read: each reads the section of its name
/// into `project` and needs those before it. All throw InputError naming file, line and key.
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
/// Spheres; then what `design` and `plan` need: limits, the posture at rest, chains.
void SetMotionDefaults(Project& project);
void ReadCollision(const YamlValue& section, Project& project);
void ReadDesign(const YamlValue& section, Project& project);
/// A robot holds its posture of rest: efforts that gravity would nearly use up in it, while the
/// root link is held, are raised with a warning.
void CarryRest(Project& project);
/// `instruments`: whether there are others than plates.
void ReadContact(const YamlValue& section, bool instruments, Project& project);
void ReadInstruments(const YamlValue& section, Project& project);
/// Of the same section: cameras, tags, and every camera's view of every tag that can move against
/// it.
void ReadCameras(const YamlValue& section, Project& project);
/// Makes the markers, whose columns have been read, instruments like others.
void ObserveMarkers(Project& project);
void ReadCalibrationOptions(const YamlValue& section, const RobotTree& tree,
                            CalibrationOptions& options);

constexpr double kOneDegree = M_PI / 180.0;  // rad
constexpr double kOneMm = 1e-3;              // m

constexpr std::size_t kMostInstruments = 1000;

/// The items of a list of the section `instruments`; none where the key is absent.
std::vector<YamlValue> InstrumentList(const YamlValue& section, const char* key);

/// `size` numbers of a list, each within its bounds.
Eigen::VectorXd NumbersOf(const YamlValue& list, std::size_t size);

/// Three coordinates in mm as a point in m.
Eigen::Vector3d PointFromMm(const YamlValue& value);
/// The same of a key, or the origin without it.
/// A direction of length 1 from three numbers.
Eigen::Vector3d DirectionFrom(const YamlValue& value);
Eigen::Vector3d OptionalPoint(const YamlValue& value, const char* key);
/// A pose [m] from the keys `xyz_mm` and `rpy_deg`, each of which may be absent.
Transform PoseFromMm(const YamlValue& value);

/// What `find` returns; the InputError that it throws is said of `value`.
template <typename Find>
auto FindNamedBy(const YamlValue& value, const Find& find) {
  try {
    return find();
  } catch (const InputError& error) {
    value.Fail(error.what());
  }
}

/// The name of a new item: no text where one of `items` has it already. `what` is what they are.
template <typename Items>
std::string NewName(const YamlValue& name, const char* what, const Items& items) {
  for (const auto& item : items) {
    if (item.name == name.Text()) {
      name.Fail(std::string("a second ") + what + " of the name " + Quote(item.name));
    }
  }
  return name.Text();
}

/// Fails unless the text can name a file: letters, digits, underscore, point and hyphen, and not
/// only one or two points. So no file lands outside of its folder.
void CheckFileName(const YamlValue& name);

/// The link, links or movable joint that a value names.
int LinkNamedBy(const YamlValue& value, const RobotTree& tree);
std::vector<int> LinksNamedBy(const YamlValue& list, const RobotTree& tree);
int JointNamedBy(const YamlValue& value, const RobotTree& tree);
/// The joint `name`, a key whose value is `value`, with a position of its own: what another joint
/// decides cannot be recorded or given.
int DriverNamedBy(const std::string& name, const YamlValue& value, const RobotTree& tree);
/// The chain that a value names: index into Project::chains.
int ChainNamedBy(const YamlValue& value, const Project& project);

}  // namespace elastocal
