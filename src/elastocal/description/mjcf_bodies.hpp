// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "elastocal/files/xml_element.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// By joint of the URDF, its name in an MJCF; a joint that is not listed has the same name there.
using MjcfJointNames = std::map<std::string, std::string>;

/// By rules `URDF=MJCF`, in each of which a `*` may stand for the rest of a name
/// (`panda_*=*`). The first rule that fits a joint counts. Throws InputError for a rule without
/// '=', with `*` on one side only, or that fits no joint.
MjcfJointNames ReadMjcfJointNames(const RobotTree& tree, const std::vector<std::string>& rules);

struct MjcfBody {
  XmlElement element;
  int parent = -1;         ///< the body that carries it; -1: the world
  std::string childclass;  ///< default class of its joints; empty: the outermost one
  int joint = -1;          ///< of the URDF, that moves it; -1: none of these
  bool moves = false;      ///< has a joint, be it of the URDF or not

  std::string Name() const { return element.Has("name") ? element.Text("name") : ""; }
};

/// The bodies of an MJCF, found by their joints: what a body is called does not matter.
class MjcfBodies {
 public:
  /// Throws InputError naming file and line: a joint of the URDF that the model does not have; two
  /// of them in one body.
  MjcfBodies(const XmlElement& mujoco, const RobotTree& tree, const MjcfJointNames& names);

  const MjcfBody& MovedBy(std::size_t joint) const { return bodies_[BodyOf(joint)]; }
  /// The name of the body that carries another; empty: the world.
  std::string CarrierName(const MjcfBody& body) const;
  const std::string& JointName(std::size_t joint) const { return joint_names_[joint]; }

  /// The frame of the body that carries that of a joint, in the moving body of `tree` that it is a
  /// part of: by the joint that moves it, the link of its name, or else as the MJCF has it. Bodies
  /// on which no joint of the URDF acts are the root link. Throws InputError where the two are not
  /// parts of one moving body.
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

/// Where the MJCF has a body in the one that carries it. Throws InputError for an orientation that
/// is not given by `quat`.
Transform ReadBodyPose(const XmlElement& body);

}  // namespace elastocal
