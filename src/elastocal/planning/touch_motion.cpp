// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/touch_motion.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/smooth_step.hpp"
#include "elastocal/planning/observed_stance.hpp"
#include "elastocal/planning/project_motion.hpp"

namespace elastocal {
namespace {

/// The way down to a touch; empty where the hand does not reach so high.
Eigen::MatrixXd WayDown(const Project& project, const RobotTree& tree, int plate,
                        const Transform& T_world_root, const Eigen::VectorXd& touch,
                        const ApproachOptions& options, double rate_hz) {
  const ObservationSetup& setup = project.contact->setup;
  const ContactPlate& of = setup.plates[Size(plate)];
  MovingChain hand = HandOf(tree, setup, plate, touch);
  const Transform T_root_touch =
      LinkTransforms(tree, touch)[Size(of.link)] * DescribedPlate(of).T_link_face;
  const Eigen::Vector3d up = T_world_root.linear().transpose() * Eigen::Vector3d::UnitZ();
  const Eigen::Index samples = std::lround(options.duration_s * rate_hz) + 1;
  Eigen::MatrixXd way(samples, touch.size());
  Eigen::VectorXd q = touch;
  for (Eigen::Index i = samples - 1; i >= 0; --i) {
    const double done = static_cast<double>(i) / static_cast<double>(samples - 1);
    Transform T_root_face = T_root_touch;
    T_root_face.translation() += options.height * (1.0 - SmoothStep(done)) * up;
    if (!ReachWithPlate(hand, of, T_root_face, project.motion.lower, project.motion.upper, q)) {
      return {};
    }
    way.row(i) = q.transpose();
  }
  way.row(samples - 1) = touch.transpose();
  return way;
}

}  // namespace

std::vector<PostureTour> TouchTours(const Project& project, const StandingRobot& robot,
                                    const std::vector<ChainPostures>& chains,
                                    const ApproachOptions& options, double rate_hz) {
  const std::vector<ContactPlate>& plates = project.contact->setup.plates;
  std::vector<PostureTour> tours = PostureTours(robot, chains);
  for (PostureTour& tour : tours) {
    tour.legs_given = true;
    const auto plate = std::find_if(plates.begin(), plates.end(),
                                    [&](const ContactPlate& of) { return of.name == tour.name; });
    const int index = static_cast<int>(plate - plates.begin());
    if (plate == plates.end() || !project.contact->tables[Size(index)]) continue;
    for (const Eigen::VectorXd& q : tour.postures) {
      tour.approaches.push_back(
          WayDown(project, robot.tree, index, RootOnFloor(robot, q), q, options, rate_hz));
    }
  }
  return tours;
}

}  // namespace elastocal
