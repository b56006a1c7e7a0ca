// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/standing_robot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/robot/shared_support.hpp"

namespace elastocal {
namespace {

constexpr double kFlat = 20.0 * M_PI / 180.0;  // more than the errors of any robot
constexpr int kFewestUpside = 3;               // postures
constexpr double kClosed = 1e-4;               // m
constexpr double kClosedAngle = 0.01 * M_PI / 180.0;

double DegreesOf(double angle) { return angle * 180.0 / M_PI; }

/// Pose of the root link on the floor by the nominal robot; without feet it is held still.
Transform NominalRoot(const ObservationSetup& setup, const std::vector<Transform>& T_root_link) {
  if (setup.feet.empty()) return Transform::Identity();
  std::vector<StandingFoot> feet;
  for (const ContactFoot& foot : setup.feet) {
    feet.push_back({T_root_link[foot.link], foot.T_floor_foot, foot.share});
  }
  return PlaceRootOnFeet(feet).T_floor_root;
}

/// For each plate: angle between its normal and the vertical by the nominal robot.
std::vector<double> NominalTilts(const RobotTree& tree, const ObservationSetup& setup,
                                 const Eigen::VectorXd& q) {
  const std::vector<Transform> T = LinkTransforms(tree, q);
  const Transform root = NominalRoot(setup, T);
  std::vector<double> tilts;
  for (const ContactPlate& plate : setup.plates) {
    const double up = (root.linear() * T[plate.link].linear() * plate.face.R_link_face)(2, 2);
    tilts.push_back(std::acos(std::clamp(up, -1.0, 1.0)));
  }
  return tilts;
}

InputError UpsideDown(const std::string& source, const std::string& plate, int upside,
                      const std::string& of) {
  return InputError(source + ": by nominal kinematics plate '" + plate + "' lies upside down in " +
                    std::to_string(upside) + " of " + of +
                    ": its normal points out of the table, contact.plates of the project says "
                    "which way that is");
}

std::string Rounded(double value, const char* format) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

}  // namespace

void PlaceFeet(const RobotTree& tree, const Eigen::MatrixXd& q, const std::vector<char>& placed,
               ObservationSetup& setup) {
  if (setup.feet.empty()) return;
  const std::vector<Transform> upright =
      LinkTransforms(tree, Eigen::VectorXd::Zero(tree.coordinate_count()));
  for (ContactFoot& foot : setup.feet) {
    foot.T_floor_foot.linear() = upright[foot.link].linear();
    foot.share = 1.0 / static_cast<double>(setup.feet.size());
  }
  const ContactFoot& first = setup.feet.front();
  for (std::size_t f = 1; f < setup.feet.size(); ++f) {
    if (placed[f] != 0) continue;
    ContactFoot& foot = setup.feet[f];
    Eigen::VectorXd x(q.rows());
    Eigen::VectorXd y(q.rows());
    Eigen::VectorXd yaw(q.rows());
    for (Eigen::Index i = 0; i < q.rows(); ++i) {
      const std::vector<Transform> T = LinkTransforms(tree, Eigen::VectorXd(q.row(i)));
      const Transform at = first.T_floor_foot * T[first.link].inverse() * T[foot.link];
      const Eigen::Matrix3d turned = at.linear() * foot.T_floor_foot.linear().transpose();
      x[i] = at.translation().x();
      y[i] = at.translation().y();
      yaw[i] = std::atan2(turned(1, 0), turned(0, 0));
    }
    foot.T_floor_foot.linear() = RotZ(Median(yaw)).linear() * foot.T_floor_foot.linear();
    foot.T_floor_foot.translation() << Median(x), Median(y), 0.0;
  }
}

std::vector<int> FindTouchingPlates(const RobotTree& tree, const ObservationSetup& setup,
                                    const Eigen::MatrixXd& q, const std::string& source) {
  std::vector<int> touching;
  Eigen::VectorXd least(q.rows());
  // Numbers of postures.
  std::vector<int> flat(setup.plates.size(), 0), upside(setup.plates.size(), 0);
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    const std::vector<double> tilts = NominalTilts(tree, setup, q.row(i));
    const auto flattest = std::min_element(tilts.begin(), tilts.end());
    touching.push_back(static_cast<int>(flattest - tilts.begin()));
    least[i] = *flattest;
    const auto steepest = std::max_element(tilts.begin(), tilts.end());
    if (*flattest <= std::min(kFlat, M_PI - *steepest)) {
      ++flat[Size(touching.back())];
    } else if (M_PI - *steepest <= kFlat) {
      ++upside[Size(steepest - tilts.begin())];
    }
  }
  for (std::size_t p = 0; p < setup.plates.size(); ++p) {
    if (upside[p] < kFewestUpside || upside[p] <= flat[p]) continue;
    throw UpsideDown(source, setup.plates[p].name, upside[p],
                     std::to_string(q.rows()) + " postures, in which no other lies as flat");
  }
  if (Median(least) <= kFlat) return touching;
  throw InputError(
      source + ": by nominal kinematics no plate lies flat on a level table; the flattest is at " +
      Rounded(DegreesOf(Median(least)), "%.0f") + " degrees in the median" +
      "; plates within 20 degrees of level were expected (contact.plates and contact.feet of the "
      "project)");
}

void CheckNamedPlates(const RobotTree& tree, const ObservationSetup& setup,
                      const Eigen::MatrixXd& q, const std::vector<int>& plates,
                      const std::string& source) {
  std::vector<int> touches(setup.plates.size(), 0), upside(setup.plates.size(), 0);
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    if (plates[Size(i)] < 0) continue;
    const std::size_t plate = Size(plates[Size(i)]);
    ++touches[plate];
    if (M_PI - NominalTilts(tree, setup, q.row(i))[plate] <= kFlat) ++upside[plate];
  }
  for (std::size_t p = 0; p < touches.size(); ++p) {
    if (upside[p] < kFewestUpside || 2 * upside[p] <= touches[p]) continue;
    throw UpsideDown(source, setup.plates[p].name, upside[p],
                     std::to_string(touches[p]) + " touches");
  }
}

ClosureEvidence CheckClosure(const ObservedRobot& model, const Eigen::MatrixXd& q) {
  ClosureEvidence evidence;
  evidence.postures = static_cast<int>(q.rows());
  if (model.setup.feet.empty()) return evidence;
  Eigen::VectorXd distances = Eigen::VectorXd::Zero(q.rows());
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    const std::vector<Transform> T = LinkTransforms(model.robot.tree, Eigen::VectorXd(q.row(i)));
    std::vector<StandingFoot> feet;
    for (const ContactFoot& foot : model.setup.feet) {
      feet.push_back({T[foot.link], foot.T_floor_foot, foot.share});
    }
    const auto closure = FootClosure(feet);
    if (closure.cols() == 0) continue;
    distances[i] = closure.topRows<3>().colwise().norm().maxCoeff();
    const double angle = closure.bottomRows<3>().colwise().norm().maxCoeff();
    if (distances[i] < kClosed && angle < kClosedAngle) ++evidence.exact;
  }
  evidence.median = q.rows() > 0 ? Median(distances) : 0.0;
  return evidence;
}

std::string DescribeClosure(const ClosureEvidence& closure) {
  const std::string median = Rounded(1e3 * closure.median, "%.3g") + " mm";
  if (!closure.planned()) {
    return "by nominal kinematics the feet are off their places by " + median +
           " in the median; this is not used as evidence";
  }
  return "the feet's closure is refused as evidence: nominal kinematics closes it (to " + median +
         " in the median, exactly in " + std::to_string(closure.exact) + " of " +
         std::to_string(closure.postures) +
         " postures), so the encoders repeat a plan that was made with the nominal model";
}

}  // namespace elastocal
