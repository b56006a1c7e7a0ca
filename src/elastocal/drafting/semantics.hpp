// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Part of a robot that somebody gave a name.
struct SemanticGroup {
  std::string name;
  std::string tip_link;             ///< of its chain; empty: it has none
  std::vector<std::string> joints;  ///< named one by one
};

/// What an SRDF says that a draft can use. Nothing is checked against a robot yet.
struct Semantics {
  std::string source;  ///< the file; empty: there is none
  std::vector<SemanticGroup> groups;
  std::vector<std::string> end_links;  ///< that carry an end effector
  /// Named postures: joint to position [rad or m].
  std::vector<std::pair<std::string, std::map<std::string, double>>> states;
  /// Pairs of links that are not checked for collisions, the lesser name first.
  std::set<std::pair<std::string, std::string>> apart;
};

/// Reads an SRDF (the semantic description that belongs to a URDF). Values of joints with several
/// degrees of freedom are passed over. Throws InputError naming file and line: malformed XML, no
/// element `robot`, an element without its name or link, nothing of use.
Semantics ParseSemantics(const std::string& text, const std::string& source);

/// Throws InputError where the robot has none of the joints and links that it names.
void CheckBelongs(const Semantics& semantics, const RobotTree& tree);

}  // namespace elastocal
