#pragma once

#include "elastocal/io/project.hpp"
#include "elastocal/io/yaml_value.hpp"

namespace elastocal {

/// Parts of a project file, in the order in which they are read: each reads the section of its name
/// into `project` and needs those before it. All throw InputError naming file, line and key.
void ReadMarkers(const YamlValue& section, Project& project);
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
void ReadCalibrationOptions(const YamlValue& section, CalibrationOptions& options);

/// The link or movable joint that a value names.
int LinkNamedBy(const YamlValue& value, const RobotTree& tree);
int JointNamedBy(const YamlValue& value, const RobotTree& tree);
/// The joint `name`, a key whose value is `value`, with a position of its own: what another joint
/// decides cannot be recorded or given.
int DriverNamedBy(const std::string& name, const YamlValue& value, const RobotTree& tree);
/// The chain that a value names: index into Project::chains.
int ChainNamedBy(const YamlValue& value, const Project& project);

}  // namespace elastocal
