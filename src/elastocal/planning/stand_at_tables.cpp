// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/stand_at_tables.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/planning/observed_stance.hpp"
#include "elastocal/planning/project_motion.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

/// Moves the soles of the robot to the feet of the set-up, and the feet that the project leaves
/// open to the soles.
void PlaceOnFloor(const Project& project, ObservationSetup& setup, StandingRobot& robot) {
  Transform T_floor_world = Transform::Identity();
  for (std::size_t f = 0; f < setup.feet.size(); ++f) {
    ContactFoot& foot = setup.feet[f];
    const auto sole = std::find_if(robot.soles.begin(), robot.soles.end(),
                                   [&](const Sole& of) { return of.link == foot.link; });
    if (sole == robot.soles.end()) {
      throw InputError(project.file.string() + ": the foot " +
                       Quote(project.tree.links[Size(foot.link)].name) +
                       " of contact.feet has no sole in the section 'standing', by which the robot "
                       "is balanced");
    }
    Transform& T_world_sole =
        robot.T_world_sole[Size(static_cast<int>(sole - robot.soles.begin()))];
    foot.share = 1.0 / static_cast<double>(setup.feet.size());
    foot.T_floor_foot.linear() = T_world_sole.linear();
    if (f == 0) T_floor_world = foot.T_floor_foot * T_world_sole.inverse();
    if (project.contact->foot_placed[f] == 0) {
      foot.T_floor_foot.translation() = (T_floor_world * T_world_sole).translation();
    }
    T_world_sole = foot.T_floor_foot;
  }
  robot.T_world_root = T_floor_world * robot.T_world_root;
}

/// Distance of a point to the body below the top of a table; negative inside.
double DistanceToTable(const TableTop& table, const Eigen::Vector3d& p_world) {
  const Eigen::Vector3d p = p_world - table.centre;
  const Eigen::Vector3d beyond(std::abs(p.x()) - 0.5 * table.size.x(),
                               std::abs(p.y()) - 0.5 * table.size.y(), p.z());
  return beyond.maxCoeff() < 0.0 ? beyond.maxCoeff() : beyond.cwiseMax(0.0).norm();
}

/// A table, and the parts of the robot that must not be inside it.
class TableClearance {
 public:
  TableClearance(const TableTop& table, const ContactPlate& plate, const RobotTree& tree,
                 const std::vector<CollisionSphere>& spheres)
      : table_(table), link_(plate.link) {
    const PhysicalPlate face = DescribedPlate(plate);
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-0.5, 0.5}) {
        corners_.emplace_back(face.T_link_face * Eigen::Vector3d(x * face.edge, y * face.edge, 0));
      }
    }
    // Spheres of the hand that extend beyond the plate are rounder than the hand.
    const std::vector<Transform> T_root_link =
        LinkTransforms(tree, Eigen::VectorXd::Zero(tree.coordinate_count()));
    for (const CollisionSphere& sphere : spheres) {
      const Transform T_face_link =
          (T_root_link[Size(link_)] * face.T_link_face).inverse() * T_root_link[Size(sphere.link)];
      const bool of_hand = tree.links[Size(sphere.link)].body == tree.links[Size(link_)].body;
      if (of_hand && (T_face_link * sphere.p_link_centre).z() < sphere.radius) continue;
      spheres_.push_back(sphere);
    }
  }

  double Of(const std::vector<Transform>& T_world_link) const {
    double least = std::numeric_limits<double>::infinity();
    for (const CollisionSphere& sphere : spheres_) {
      const Eigen::Vector3d centre = T_world_link[Size(sphere.link)] * sphere.p_link_centre;
      least = std::min(least, DistanceToTable(table_, centre) - sphere.radius);
    }
    for (const Eigen::Vector3d& corner : corners_) {
      least = std::min(least, DistanceToTable(table_, T_world_link[Size(link_)] * corner));
    }
    return least;
  }

 private:
  TableTop table_;
  int link_;
  std::vector<CollisionSphere> spheres_;
  std::vector<Eigen::Vector3d> corners_;  // corners of the plate, in the frame of its link
};

/// Moves the robot into its posture of rest on displaced soles.
void RestOnSoles(const Project& project, StandingRobot& robot) {
  PlacedPosture rest{robot.rest, robot.T_world_root};
  if (!BalanceAtRest(robot, robot.AllFeet(), SupportCentre(robot, robot.AllFeet()), rest)) {
    throw InputError(
        project.file.string() +
        ": in its posture of rest, the robot does not reach the places of contact.feet");
  }
  robot.rest = rest.q;
  robot.T_world_root = rest.T_world_root;
}

}  // namespace

std::unique_ptr<StandingRobot> StandAtTables(const Project& project, const MotionLimits& limits,
                                             ObservationSetup& setup) {
  constexpr double kRounding = 1e-5;  // m
  auto robot = setup.feet.empty()
                   ? std::make_unique<StandingRobot>(project.tree, std::vector<Sole>(), limits)
                   : StandProjectRobot(project, limits);
  if (setup.feet.empty()) {
    StandUp(*robot, project.motion.rest, {});
  } else {
    PlaceOnFloor(project, setup, *robot);
    RestOnSoles(project, *robot);
  }
  std::vector<TableClearance> tables;
  for (std::size_t plate = 0; plate < setup.plates.size(); ++plate) {
    const std::optional<TableTop>& table = project.contact->tables[plate];
    if (!table) continue;
    tables.emplace_back(*table, setup.plates[plate], robot->tree, project.motion.spheres);
  }
  if (tables.empty()) return robot;
  robot->clearances = [&robot = *robot, own = robot->clearances, tables](const Eigen::VectorXd& q) {
    const Eigen::VectorXd parts = own ? own(q) : Eigen::VectorXd();
    const Transform T_world_root = RootOnFloor(robot, q);
    std::vector<Transform> T_world_link = LinkTransforms(robot.tree, q);
    for (Transform& T : T_world_link) T = T_world_root * T;
    Eigen::VectorXd all(parts.size() + static_cast<Eigen::Index>(tables.size()));
    all.head(parts.size()) = parts;
    for (std::size_t k = 0; k < tables.size(); ++k) {
      all[parts.size() + static_cast<Eigen::Index>(k)] =
          tables[k].Of(T_world_link) + robot.limits.clearance + kRounding;
    }
    return all;
  };
  return robot;
}

}  // namespace elastocal
