// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/root_watch.hpp"

#include <bit>
#include <string>

#include "elastocal/math/numbers.hpp"
#include "elastocal/planning/compensate_motion.hpp"

namespace elastocal {

RootWatch::RootWatch(const Project& project, const StoredCalibration& calibration,
                     RuntimeContent content)
    : project_(project), robot_(MakeRuntimeModel(project, calibration, content)) {
  for (const std::string& name : robot_.model().foot_names) {
    const int link = project.chains[Size(FindChain(project, name))].tip_link;
    int of_foot = -1;
    for (std::size_t i = 0; i < project.soles.size(); ++i) {
      if (project.soles[i].link == link) of_foot = static_cast<int>(i);
    }
    sole_of_foot_.push_back(of_foot);
  }
}

void RootWatch::Look(const std::vector<int>& support, const VirtualRobot& body) {
  const StandingFeet feet = FeetOfLinks(project_, robot_.model(), support);
  if (feet == 0) return;
  const int sole = sole_of_foot_[Size(std::countr_zero(feet))];
  if (sole < 0) return;
  robot_.Forward(body.Encoders(), Eigen::VectorXd(), feet);
  Transform known = Transform::Identity();
  known.matrix() = robot_.root_pose().matrix();
  (std::has_single_bit(feet) ? one_ : several_)
      .Add(body.SolePose(sole).inverse() * body.WaistPose(), known);
}

}  // namespace elastocal
