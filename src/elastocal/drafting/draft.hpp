// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/drafting/clusters.hpp"
#include "elastocal/drafting/limbs.hpp"
#include "elastocal/drafting/rest_posture.hpp"
#include "elastocal/drafting/soles.hpp"
#include "elastocal/drafting/spheres.hpp"
#include "elastocal/robot/motion_setup.hpp"

namespace elastocal {

/// Share of the motors' efforts that drafted postures may use.
inline constexpr double kDraftedEffort = 0.85;

/// A chain of a draft.
struct DraftedChain {
  std::string name;
  int from_link = 0, tip_link = 0;
  bool trunk = false;  ///< ends at a moving part that carries limbs
};

/// Contents of a drafted project file, as far as the robot description tells.
struct ProjectDraft {
  std::string urdf;  ///< text of the URDF, with added links for missing soles
  RobotTree tree;    ///< tree of that text
  RobotShapes shapes;
  Limbs limbs;
  std::vector<DraftedChain> chains;
  std::vector<DraftedCluster> clusters;
  std::vector<DraftedSole> soles;
  std::vector<CollisionSphere> spheres;
  double sphere_margin = 0.0;  ///< m
  std::map<int, double> room;  ///< at the limits of entries of q, rad (design.room_deg)
  RestPosture rest;
  std::vector<ChainSetup> designs;
  /// Share of the motors' efforts that planned motions may use: larger than usual where the robot
  /// could not lift a foot otherwise.
  double motion_effort_share = MotionSetup{}.motion_effort_share;
  /// Restricted ranges of some entries of q: of waists, in which feet can keep their places, and of
  /// elbows and knees, in which limbs are bent.
  std::map<int, Eigen::Vector2d> ranges, bent_ranges;
  /// The soles are written to the project, because the robot can stand on them.
  bool stands = false;
  std::string held_because;           ///< reason why it cannot stand although there are soles
  std::optional<double> stance;       ///< m; given where the feet are too close in the zero posture
  std::vector<std::string> warnings;  ///< what the user should check first
};

/// Drafts a project from a URDF and, if there is one, its SRDF. `source` names the URDF in
/// messages; `places` says where its meshes are. The same files give the same draft. Throws
/// InputError for texts that cannot be read and for a robot without movable joints.
ProjectDraft DraftProject(const std::string& urdf, const std::string& source,
                          const Semantics& semantics, const MeshPlaces& places = {});

/// The draft as a project file (docs/formats.md), with comments that tell the origin of its values.
/// `urdf` is the path of the robot description relative to that file.
std::string FormatDraft(const ProjectDraft& draft, const std::string& urdf);

/// Throws InputError with the reason if the draft cannot be read as the project `file`. `urdf` is
/// a file with the draft's robot description.
void RequireReadable(const ProjectDraft& draft, const std::filesystem::path& file,
                     const std::filesystem::path& urdf);

/// The draft as JSON.
std::string FormatDraftSummary(const ProjectDraft& draft);

}  // namespace elastocal
