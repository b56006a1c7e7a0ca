// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "elastocal/files/xml_element.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Names of joints in an MJCF, by their names in the URDF; a joint that is not listed has the same
/// name in both.
using MjcfJointNames = std::map<std::string, std::string>;

/// Names of joints by rules `URDF=MJCF`, in which a `*` on both sides may stand for the rest of a
/// name (`panda_*=*`). The first rule that fits a joint counts. Throws InputError for a rule
/// without '=', with `*` on one side only, or that fits no joint.
MjcfJointNames ReadMjcfJointNames(const RobotTree& tree, const std::vector<std::string>& rules);

/// A body of an MJCF.
struct MjcfBody {
  XmlElement element;
  int parent = -1;         ///< the body that carries it; -1: the world
  std::string childclass;  ///< default class of its joints; empty: the outermost one
  int joint = -1;          ///< joint of the URDF that moves it; -1: none
  bool moves = false;      ///< whether it has a joint, of the URDF or not

  std::string Name() const { return element.Has("name") ? element.Text("name") : ""; }
};

/// The bodies of an MJCF, found by their joints; names of bodies do not matter.
class MjcfBodies {
 public:
  /// Throws InputError naming file and line: a joint of the URDF that the model does not have; two
  /// of them in one body.
  MjcfBodies(const XmlElement& mujoco, const RobotTree& tree, const MjcfJointNames& names);

  const MjcfBody& MovedBy(std::size_t joint) const { return bodies_[BodyOf(joint)]; }
  /// The name of the body that carries another; empty: the world.
  std::string CarrierName(const MjcfBody& body) const;
  const std::string& JointName(std::size_t joint) const { return joint_names_[joint]; }

  /// Frame of the body that carries the moved body of a joint, in the frame of the moving body of
  /// `tree` to which it belongs. It is found by the joint that moves it, by the link with its name,
  /// or else by its pose in the MJCF. A body that no joint of the URDF moves belongs to the root
  /// link. Throws InputError if the carrier is not part of the moving body that carries the joint
  /// in `tree`.
  Transform CarrierFrame(const RobotTree& tree, std::size_t joint) const;

 private:
  struct Frame {
    int body = 0;
    Transform T_body = Transform::Identity();
  };
  void Collect(const XmlElement& within, int parent, const std::string& childclass);
  std::size_t BodyOf(std::size_t joint) const { return static_cast<std::size_t>(body_of_[joint]); }
  Frame FrameOf(const RobotTree& tree, int body) const;

  std::vector<MjcfBody> bodies_;
  std::vector<int> body_of_;              ///< by joint of the URDF
  std::vector<std::string> joint_names_;  ///< likewise, in the MJCF
};

/// Pose of a body in the body that carries it, by the MJCF. Throws InputError for an orientation
/// that is not given by `quat`.
Transform ReadBodyPose(const XmlElement& body);

}  // namespace elastocal
