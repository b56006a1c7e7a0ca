// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/observed_stance.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/observation/standing_robot.hpp"
#include "elastocal/planning/project_motion.hpp"
#include "elastocal/planning/stand_at_tables.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr int kTries = 400;
constexpr int kTriesOfLooks = 40000;  // nearly all end before legs are placed

/// Coordinates of the joints that move a link, without those of a foot's leg.
std::vector<int> CoordinatesBefore(const RobotTree& tree, const ObservationSetup& setup, int link) {
  std::set<int> of_legs;
  for (const ContactFoot& foot : setup.feet) {
    for (int k : JointsToBody(tree, tree.links[Size(foot.link)].body)) of_legs.insert(k);
  }
  std::vector<int> coordinates;
  for (int k : JointsToBody(tree, tree.links[Size(link)].body)) {
    const int coordinate = tree.joints[Size(k)].coordinate;
    const bool known =
        std::find(coordinates.begin(), coordinates.end(), coordinate) != coordinates.end();
    if (!of_legs.contains(k) && !known) coordinates.push_back(coordinate);
  }
  return coordinates;
}

}  // namespace

PhysicalPlate DescribedPlate(const ContactPlate& plate, double edge) {
  PhysicalPlate physical{plate.link, Transform::Identity(), edge};
  physical.T_link_face.linear() = plate.face.R_link_face;
  physical.T_link_face.translation() = plate.face.p_link_face;
  return physical;
}

std::vector<int> HandCoordinates(const RobotTree& tree, const ObservationSetup& setup, int plate) {
  const std::vector<int> all = CoordinatesBefore(tree, setup, setup.plates[Size(plate)].link);
  std::vector<int> own;
  for (int coordinate : all) {
    bool shared = false;
    for (const ContactPlate& other : setup.plates) {
      if (other.link == setup.plates[Size(plate)].link) continue;
      const std::vector<int> of = CoordinatesBefore(tree, setup, other.link);
      shared = shared || std::find(of.begin(), of.end(), coordinate) != of.end();
    }
    if (!shared) own.push_back(coordinate);
  }
  return own.size() < 3 ? all : own;
}

MovingChain HandOf(const RobotTree& tree, const ObservationSetup& setup, int plate,
                   const Eigen::VectorXd& q) {
  return {tree, CoordinatesBefore(tree, setup, setup.plates[Size(plate)].link), q};
}

bool ReachWithPlate(MovingChain& hand, const ContactPlate& plate, const Transform& T_root_face,
                    const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                    Eigen::VectorXd& q) {
  constexpr int kIterations = 60;
  constexpr double kReached = 1e-9, kDamping = 1e-3, kLargest = 0.3;
  const PhysicalPlate described = DescribedPlate(plate);
  const std::vector<int>& coordinates = hand.coordinates();
  Eigen::VectorXd x = q(coordinates);
  const Eigen::VectorXd least = lower(coordinates), most = upper(coordinates);
  for (int i = 0; i < kIterations; ++i) {
    hand.Move(x);
    const Transform found = hand.link_poses()[Size(described.link)] * described.T_link_face;
    Vector6d error;
    error << T_root_face.translation() - found.translation(),
        RotationVector(T_root_face.linear() * found.linear().transpose());
    if (error.norm() < kReached) {
      q(coordinates) = x;
      return true;
    }
    Eigen::MatrixXd J(6, hand.size());
    J << hand.PointJacobian(described.link, found.translation()),
        hand.RotationJacobian(described.link);
    // A joint at its limit that would move beyond it is left out.
    Eigen::Matrix<double, 6, 6> gram = J * J.transpose();
    gram.diagonal().array() += kDamping * std::min(1.0, error.squaredNorm());
    Eigen::VectorXd step = J.transpose() * gram.ldlt().solve(error);
    step *= std::min(1.0, kLargest / std::max(1e-12, step.cwiseAbs().maxCoeff()));
    x = (x + step).cwiseMax(least).cwiseMin(most);
  }
  return false;
}

Sight NominalSight(const ObservationSetup& setup, const Instrument& instrument,
                   const std::vector<Transform>& T_root_link, const Transform& T_floor_root) {
  Sight sight;
  for (int link : instrument.links) sight.T_floor_link.push_back(T_floor_root * T_root_link[link]);
  for (int index : instrument.quantities) {
    const Quantity& quantity = setup.quantities[Size(index)];
    sight.values.push_back({quantity.origin, Eigen::VectorXd::Zero(quantity.size())});
  }
  return sight;
}

ObservedPostureSampler::ObservedPostureSampler(const Project& project, std::uint64_t seed)
    : project_(project), random_(seed) {
  if (!project.contact) {
    throw InputError(project.file.string() + ": there is no section 'contact' or 'instruments'");
  }
  setup_ = project.contact->setup;
  robot_ = StandAtTables(project, {}, setup_);
  for (int plate = 0; plate < static_cast<int>(setup_.plates.size()); ++plate) {
    arms_.push_back(
        std::make_unique<MovingChain>(HandOf(robot_->tree, setup_, plate, robot_->rest)));
  }
  std::set<int> moved;
  for (const auto& instrument : setup_.instruments) {
    for (int link : instrument->links) {
      for (int c : CoordinatesBefore(robot_->tree, setup_, link)) moved.insert(c);
    }
  }
  moved_.assign(moved.begin(), moved.end());
}

std::vector<int> ObservedPostureSampler::support() const {
  std::vector<int> links;
  for (const ContactFoot& foot : setup_.feet) links.push_back(foot.link);
  return links;
}

bool ObservedPostureSampler::Blamed(const std::string& reason) {
  ++blame_[reason];
  return false;
}

std::string ObservedPostureSampler::Blame() const {
  const auto most =
      std::max_element(blame_.begin(), blame_.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == blame_.end() ? "nothing" : most->first;
}

PlacedPosture ObservedPostureSampler::DrawStance() {
  // Shares of the leg's length, and rad: about as far as legs reach while both feet stand.
  constexpr double kLower = 0.08, kHigher = 0.02;
  constexpr double kYaw = 0.15, kPitch = 0.12, kRoll = 0.06;
  PlacedPosture pose{robot_->rest, robot_->T_world_root};
  if (robot_->Held()) return pose;
  const auto within = [&](double most) { return random_.Uniform(-most, most); };
  pose.T_world_root.translation().z() += robot_->leg_length * random_.Uniform(-kLower, kHigher);
  pose.T_world_root.linear() =
      (RotZ(within(kYaw)) * RotY(within(kPitch)) * RotX(within(kRoll))).linear() *
      pose.T_world_root.linear();
  const double sway = 0.5 * robot_->half_support;
  com_ = SupportCentre(*robot_, robot_->AllFeet()) + Eigen::Vector2d(within(sway), within(sway));
  return pose;
}

bool ObservedPostureSampler::Balance(PlacedPosture& pose) {
  return robot_->Held() || BalanceAtRest(*robot_, robot_->AllFeet(), com_, pose);
}

bool ObservedPostureSampler::TryTouch(int plate, const TableTop& table, PlacedPosture& pose) {
  constexpr int kRounds = 12;  // balance moves the root link, and the hand reaches again
  constexpr double kStill = 1e-8;
  constexpr double kSpread = 0.25, kYaw = 0.6;
  const ContactPlate& of = setup_.plates[Size(plate)];
  for (int c : arms_[Size(plate)]->coordinates()) {
    const double range = project_.motion.upper[c] - project_.motion.lower[c];
    pose.q[c] = std::clamp(pose.q[c] + random_.Normal(kSpread * range), project_.motion.lower[c],
                           project_.motion.upper[c]);
  }
  Transform T_world_face = Transform::Identity();
  for (int i = 0; i < 2; ++i) {
    T_world_face.translation()[i] = table.centre[i] + random_.Uniform(-0.5, 0.5) * table.size[i];
  }
  T_world_face.translation().z() = table.centre.z();
  const Eigen::Matrix3d R = pose.T_world_root.linear() *
                            LinkTransforms(robot_->tree, pose.q)[Size(of.link)].linear() *
                            of.face.R_link_face;
  T_world_face.linear() = RotZ(random_.Uniform(-kYaw, kYaw)).linear() *
                          RotationBetween(R.col(2), Eigen::Vector3d::UnitZ()) * R;
  for (int round = 0; round < kRounds; ++round) {
    if (!ReachWithPlate(*arms_[Size(plate)], of, pose.T_world_root.inverse() * T_world_face,
                        project_.motion.lower, project_.motion.upper, pose.q)) {
      return Blamed("reach of the hand");
    }
    const Transform before = pose.T_world_root;
    if (!Balance(pose)) return Blamed("reach of the legs");
    if ((before.translation() - pose.T_world_root.translation()).norm() < kStill) {
      return ReachesAbove(plate, pose) || Blamed("reach of the hand above the table");
    }
  }
  return Blamed("balance");
}

/// Whether the hand reaches the touch from above, as in a motion that is planned later.
bool ObservedPostureSampler::ReachesAbove(int plate, const PlacedPosture& touch) {
  const ContactPlate& of = setup_.plates[Size(plate)];
  Transform T_root_face =
      LinkTransforms(robot_->tree, touch.q)[Size(of.link)] * DescribedPlate(of).T_link_face;
  T_root_face.translation() +=
      kApproachHeight * touch.T_world_root.linear().transpose() * Eigen::Vector3d::UnitZ();
  Eigen::VectorXd q = touch.q;
  return ReachWithPlate(*arms_[Size(plate)], of, T_root_face, project_.motion.lower,
                        project_.motion.upper, q);
}

bool ObservedPostureSampler::Feasible(const PlacedPosture& pose) {
  if (((pose.q - project_.motion.lower).array() < 0.0).any() ||
      ((project_.motion.upper - pose.q).array() < 0.0).any()) {
    return Blamed("limits of joints");
  }
  for (const int knee : robot_->knees) {
    if (std::abs(pose.q[knee]) < robot_->limits.least_knee) return Blamed("straight legs");
  }
  if (robot_->clearances) {
    Eigen::Index nearest = 0;
    const Eigen::VectorXd clearances = robot_->clearances(pose.q);
    if (clearances.size() > 0 && clearances.minCoeff(&nearest) < robot_->limits.clearance) {
      const auto parts = static_cast<Eigen::Index>(AllContacts(project_).size());
      return Blamed(nearest < parts ? "parts of the robot that meet" : "the tables");
    }
  }
  return true;
}

std::optional<Eigen::VectorXd> ObservedPostureSampler::DrawTouch(int plate) {
  const std::optional<TableTop>& table = project_.contact->tables[Size(plate)];
  if (!table) {
    throw InputError(project_.file.string() +
                     ": contact.plates: " + Quote(setup_.plates[Size(plate)].name) +
                     " has no 'table: {centre_mm, size_mm}', which says where it is to touch");
  }
  blame_.clear();
  for (int i = 0; i < kTries; ++i) {
    PlacedPosture pose = DrawStance();
    if (TryTouch(plate, *table, pose) && Feasible(pose)) return pose.q;
  }
  return std::nullopt;
}

std::optional<Eigen::VectorXd> ObservedPostureSampler::DrawLook() {
  blame_.clear();
  // A camera and a tag that are both on the robot tell more than one of them in the room.
  const std::vector<TagInCamera>& views = project_.contact->seen_tags;
  const auto between_links = [&](const TagInCamera& view) {
    return setup_.instruments[Size(view.instrument)]->links.size() == 2;
  };
  const bool any_between = std::any_of(views.begin(), views.end(), between_links);
  const auto sees = [&](const PlacedPosture& pose) {
    const std::vector<Transform> T_root_link = LinkTransforms(robot_->tree, pose.q);
    return views.empty() || std::any_of(views.begin(), views.end(), [&](const TagInCamera& view) {
             const Instrument& seen = *setup_.instruments[Size(view.instrument)];
             return (between_links(view) || !any_between) &&
                    seen.Sees(NominalSight(setup_, seen, T_root_link, pose.T_world_root));
           });
  };
  for (int i = 0; i < kTriesOfLooks; ++i) {
    PlacedPosture pose = DrawStance();
    for (int c : moved_) {
      pose.q[c] = random_.Uniform(project_.motion.lower[c], project_.motion.upper[c]);
    }
    if (!sees(pose)) {
      Blamed("view of the cameras");
    } else if (!Balance(pose)) {
      Blamed("reach of the legs");
    } else if (Feasible(pose) && (sees(pose) || Blamed("view of the cameras"))) {
      return pose.q;
    }
  }
  return std::nullopt;
}

}  // namespace elastocal
