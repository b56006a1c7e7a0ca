// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/project/project.hpp"
#include "elastocal/robot/joint_motion.hpp"

namespace elastocal {

/// Name in a posture file of postures in which instruments look at the robot, if the project has
/// `contact` or `instruments`. (Other postures then have the name of the plate that touches its
/// table.)
inline constexpr const char* kLooks = "instruments";

/// Calibration postures of one chain (or of a plate, or kLooks), with the feet that stand
/// meanwhile.
struct ChainPostures {
  std::string chain;
  std::vector<int> support;        ///< links
  std::vector<Eigen::VectorXd> q;  ///< by coordinate of the tree, rad or m
};

/// The text of a posture file (docs/formats.md): one entry a chain, one line a posture, all joints
/// that move (mimic joints aside), rad or m.
std::string FormatPostureFile(const RobotTree& tree, const std::vector<ChainPostures>& chains);

/// Reads one. Joints that a posture leaves out are at rest (project.motion.rest). Throws InputError
/// naming file, line and key: unknown chain, joint or link, a joint beyond its limits by more than
/// 1e-6, nothing in it.
std::vector<ChainPostures> ReadPostureFile(const std::filesystem::path& file,
                                           const Project& project);
std::vector<ChainPostures> ParsePostureFile(const std::string& text, const std::string& source,
                                            const Project& project);

/// The postures one after the other, for those that play lists of postures.
JointMotion ListPostures(const std::vector<ChainPostures>& chains, const std::string& source);

}  // namespace elastocal
