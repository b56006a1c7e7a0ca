// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// A named part of a robot.
struct SemanticGroup {
  std::string name;
  std::string tip_link;             ///< tip of its chain; empty: it has none
  std::vector<std::string> joints;  ///< joints that are listed by name
};

/// The contents of an SRDF that a draft uses, not yet compared with a robot.
struct Semantics {
  std::string source;  ///< path of the file; empty: there is none
  std::vector<SemanticGroup> groups;
  std::vector<std::string> end_links;  ///< links that carry an end effector
  /// Named postures: position [rad or m] by joint.
  std::vector<std::pair<std::string, std::map<std::string, double>>> states;
  /// Pairs of links whose collisions are not checked, each in alphabetical order.
  std::set<std::pair<std::string, std::string>> apart;
};

/// Reads an SRDF (the semantic description of a URDF). Values of joints with several degrees of
/// freedom are ignored. Throws InputError that names file and line, for malformed XML, a missing
/// element `robot`, an element without its name or link, and a file without anything usable.
Semantics ParseSemantics(const std::string& text, const std::string& source);

/// Throws InputError where the robot has none of the joints and links that the SRDF names.
void CheckBelongs(const Semantics& semantics, const RobotTree& tree);

}  // namespace elastocal
