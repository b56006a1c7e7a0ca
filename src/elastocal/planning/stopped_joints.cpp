// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/stopped_joints.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace elastocal {
namespace {

constexpr double kDegreesARadian = 180.0 / M_PI;

/// At which length turns count at the end of the worst limb that a coordinate moves
/// (Compensator::left_m).
double ArmOfWorstLimb(const Compensator& compensator, std::size_t coordinate) {
  const ec_robot& robot = compensator.robot();
  double most = -1.0, arm_m = 0.0;
  for (int t = 0; t < robot.tips; ++t) {
    const ec_tip& tip = robot.tip[t];
    if (tip.yields != 0 || tip.branch != robot.branch_of_coordinate[coordinate]) continue;
    const double left = compensator.tip_left_m(t);
    if (left <= most) continue;
    most = left;
    arm_m = tip.arm;
  }
  return arm_m;
}

}  // namespace

std::string StoppedJoints::JointAt(const Compensator& compensator, Eigen::Index coordinate) const {
  const auto c = static_cast<std::size_t>(coordinate);
  const Joint& joint = tree_.joints[static_cast<std::size_t>(tree_.coordinate_joint[c])];
  const bool slides = joint.type == JointType::kPrismatic;
  const double scale = slides ? 1e3 : kDegreesARadian;
  const char* unit = slides ? "mm" : "deg";
  const double at = compensator.command()[coordinate];
  return fmt::format("{} (at {:.2f} {})", joint.name, scale * at, unit);
}

void StoppedJoints::Look(const Compensator& compensator, double time_s, CompensatorStatus kind,
                         Worst& worst) {
  std::vector<std::string> joints;
  double left = -1.0, arm_m = 0.0;
  bool turns = false;
  const std::vector<unsigned>& stopped = compensator.stopped();
  for (std::size_t c = 0; c < stopped.size(); ++c) {
    if (stopped[c] != kind) continue;
    joints.push_back(JointAt(compensator, static_cast<Eigen::Index>(c)));
    const Joint& joint = tree_.joints[static_cast<std::size_t>(tree_.coordinate_joint[c])];
    turns = turns || joint.type != JointType::kPrismatic;
    const double here = compensator.left_m(static_cast<int>(c));
    if (here <= left) continue;
    left = here;
    arm_m = ArmOfWorstLimb(compensator, c);
  }
  if (joints.empty()) return;
  ++worst.samples;
  if (left < worst.left_m) return;
  worst.left_m = left;
  worst.time_s = time_s;
  worst.arm_m = arm_m;
  worst.joints = std::move(joints);
  worst.turns = turns;
}

void StoppedJoints::Look(const Compensator& compensator, double time_s) {
  Look(compensator, time_s, EC_JOINT_LIMIT, limit_);
  Look(compensator, time_s, EC_CORRECTION_CUT, correction_);
}

std::vector<std::string> StoppedJoints::Describe(int samples) const {
  std::vector<std::string> sentences;
  const auto describe = [&](const Worst& worst, const char* what, const char* room,
                            const char* otherwise) {
    if (worst.samples == 0) return;
    // Joints of standing legs leave range_deg to keep the balance; the margin is one of turns.
    const char* with = worst.turns ? "--limit-margin-deg, or for an arm with a narrower "
                                     "design.range_deg of the project"
                                   : "a narrower design.range_deg of the project";
    sentences.push_back(fmt::format(
        "{}: {} at {:.2f} s, where {:.2f} mm are left at the end of its limb (a degree "
        "counts {:.1f} mm; {} of {} samples are like this); {} (design and plan again with "
        "{}){}",
        what, fmt::join(worst.joints, ", "), worst.time_s, 1e3 * worst.left_m,
        DegreeAsMillimetres(worst.arm_m), worst.samples, samples, room, with, otherwise));
  };
  describe(limit_, "stopped by a joint's limit", "plan the motion further from this limit",
           ", or widen it in the URDF if the robot can go on");
  describe(correction_,
           "stopped by the limit of a correction (its size, or its change from the last sample)",
           "plan the limb less stretched and further from limits there", "");
  return sentences;
}

}  // namespace elastocal
