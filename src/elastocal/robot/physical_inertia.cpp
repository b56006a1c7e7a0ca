// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/physical_inertia.hpp"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include <Eigen/Eigenvalues>

#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

/// A sentence if the parts that joints move weigh more than anything of that size; else empty.
std::string WarnOfHeavyParts(double moved_kg, double width_m) {
  constexpr double kMost = 300.0;  // kg/m^3 of a cube as wide as the robot: they weigh 2 to 64
  if (width_m <= 0.0 || moved_kg <= kMost * width_m * width_m * width_m) return "";
  char text[200];
  std::snprintf(text, sizeof text,
                "the parts that joints move weigh %.0f kg, in a robot that reaches %.2g m: are the "
                "masses of the URDF in kg?",
                moved_kg, 0.5 * width_m);
  return text;
}

/// By how much the two smaller principal moments are to be raised; 0 for a physical inertia.
/// `moments` in ascending order.
double MissingMoment(const Eigen::Vector3d& moments) {
  constexpr double kRounding = 1e-9;
  const double least = std::max(0.0, -moments[0]);
  const double missing = 0.5 * (moments[2] - moments[0] - moments[1]);
  return std::max(least, missing > kRounding * moments[2] ? missing : 0.0);
}

}  // namespace

Eigen::Matrix3d PhysicalInertia(const Eigen::Matrix3d& inertia) {
  constexpr double kSpare = 1e-6;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia);
  const double missing = MissingMoment(solver.eigenvalues());
  if (missing <= 0.0) return inertia;
  Eigen::Vector3d moments = solver.eigenvalues();
  moments.head<2>().array() += missing * (1.0 + kSpare);
  moments[2] = std::max(moments[2], moments[1]);
  return solver.eigenvectors() * moments.asDiagonal() * solver.eigenvectors().transpose();
}

std::vector<std::string> InertiaWarnings(const RobotTree& tree) {
  constexpr double kNotable = 0.01;  // kg: lighter links are frames with arbitrary inertias
  const double width = RobotSize(tree);
  std::vector<std::string> warnings;
  std::vector<double> mass(Size(tree.body_count()), 0.0);
  for (const Link& link : tree.links) {
    mass[Size(link.body)] += link.mass;
    const auto say = [&](const std::string& what) {
      warnings.push_back("link '" + link.name + "': " + what);
    };
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(link.inertia);
    if (MissingMoment(solver.eigenvalues()) > 0.0) {
      say("no body has the inertia of the URDF (a principal moment is negative or larger than the "
          "sum of the others); the simulator takes a balanced one");
    } else if (link.mass > 0.0 && link.inertia.isZero()) {
      say("it has a mass but no inertia");
    } else if (link.mass > kNotable && solver.eigenvalues()[2] > link.mass * width * width) {
      say("its inertia is that of a body wider than the robot: is it in kg.m^2? Motions that its "
          "joints could do will seem too much for them");
    }
  }
  const std::string heavy =
      WarnOfHeavyParts(std::accumulate(mass.begin() + 1, mass.end(), 0.0), width);
  if (!heavy.empty()) warnings.push_back(heavy);
  // A body without a mass may stand between the near joints of a shoulder; what it carries weighs.
  // One as long as a thigh has a mass.
  constexpr double kNear = 0.05;  // share of the robot's size
  for (int body = tree.body_count() - 1; body > 0; --body) {
    const Joint& joint = tree.joints[Size(body - 1)];
    const Eigen::Vector3d place =
        tree.links[Size(joint.parent_link)].T_body_link * joint.T_parent_child.translation();
    if (place.norm() < kNear * width) mass[Size(joint.parent_body)] += mass[Size(body)];
  }
  for (int body = 1; body < tree.body_count(); ++body) {
    if (mass[Size(body)] > 0.0) continue;
    const Link& link = tree.links[Size(tree.joints[Size(body - 1)].child_link)];
    warnings.push_back("link '" + link.name +
                       "': it has no mass, which statics and the simulator need");
  }
  return warnings;
}

}  // namespace elastocal
