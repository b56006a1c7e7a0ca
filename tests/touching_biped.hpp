#pragma once

#include <vector>

#include "elastocal/contact/contact_fit.hpp"
#include "elastocal/math/random.hpp"
#include "tests/biped.hpp"

namespace elastocal {

/// Adds an arm of five joints on the side of y = `side` to a trunk and returns its hand.
inline int AddArm(RobotTree& tree, const std::string& name, int trunk, double side) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  int link = AddJoint(tree, name + "_1", trunk, Offset(0, side * 0.2, 0.35), {0, 0.1, 1});
  link = AddJoint(tree, name + "_2", link, Offset(0.02, side * 0.05, 0), y);
  GiveMass(tree.links[static_cast<std::size_t>(link)], 3.0, {0.15, 0.0, 0.0});
  link = AddJoint(tree, name + "_3", link, Offset(0.28, 0, 0), y);
  link = AddJoint(tree, name + "_4", link, Offset(0.24, 0.01, 0), y);
  GiveMass(tree.links[static_cast<std::size_t>(link)], 2.0, {0.05, 0.0, 0.0});
  link = AddJoint(tree, name + "_5", link, Offset(0.05, 0, 0), x);
  for (std::size_t k = 0; k < 5; ++k) {
    tree.joints[tree.joints.size() - 5 + k].limits = {-1.5, 1.5, 5.0, 60.0};
  }
  return link;
}

/// The biped with two arms, each with a plate under its hand, on both feet. `hold`: patterns.
inline ContactModel MakeTouchingBiped(const std::vector<std::string>& hold = {}) {
  RobotTree tree = MakeBiped().tree;
  const int trunk = FindLink(tree, "trunk_pitch_link");
  ContactSetup setup;
  for (const char* side : {"left", "right"}) {
    const double y = side[0] == 'l' ? 1.0 : -1.0;
    const int hand = AddArm(tree, std::string("arm_") + side, trunk, y);
    setup.plates.push_back({side, hand, {Eigen::Vector3d(0.1, 0, -0.03), RotZ(0.3).linear()}});
    setup.feet.push_back(
        {FindLink(tree, std::string(side) + "_sole"), Offset(0, 0.085 * (y - 1), 0)});
  }
  setup.hold = hold;
  setup.common = {{"left_3.compliance_z", "right_3.compliance_z"}};
  const std::vector<int> torsion = {FindJoint(tree, "left_3"), FindJoint(tree, "right_3"),
                                    FindJoint(tree, "arm_left_2")};
  return MakeContactModel(tree, {}, setup, torsion, {FindJoint(tree, "left_3")});
}

/// A posture with bent knees, hands in front.
inline Eigen::VectorXd TouchingPosture(const ContactModel& model, Random& random) {
  const RobotTree& tree = model.robot.tree;
  Eigen::VectorXd q = random.NormalVector(tree.coordinate_count(), 0.15);
  const auto set = [&](const std::string& joint, double position) {
    q[tree.joints[FindJoint(tree, joint)].coordinate] += position;
  };
  const double knee = random.Uniform(0.4, 1.2);
  for (const char* side : {"left", "right"}) {
    const std::string leg = side;
    set(leg + "_3", -0.5 * knee);
    set(leg + "_4", knee);
    set(leg + "_5", -0.5 * knee);
    const double reach = random.Uniform(0.0, 0.9);
    set("arm_" + leg + "_2", 0.8 - reach);
    set("arm_" + leg + "_3", -0.6 + 2.0 * reach);
    set("arm_" + leg + "_1", random.Uniform(-0.6, 0.6));
    set("arm_" + leg + "_4", -0.3 - reach);
  }
  return q;
}

/// What a robot with these values and tables leaves of a touch that its encoders say is q.
inline Eigen::Vector3d LeftAt(const ContactModel& model, Touches& one,
                              const ContactValues& values) {
  return LeftOfTouches(model, one, values).row(0);
}

/// Touches of a robot with the errors `truth`: random postures in which the last three joints of
/// the arm that touches, found by Newton's method, leave what `noise` draws (height, tilts). The
/// plates take turns, and each plate has `sessions` sessions in turn.
inline Touches SimulateTouches(const ContactModel& model, const ContactValues& truth, int count,
                               int sessions, const Eigen::Vector3d& noise, Random& random) {
  Touches touches;
  touches.files = {"synthetic"};
  const int plates = static_cast<int>(model.setup.plates.size());
  for (int s = 0; s < sessions * plates; ++s) touches.sessions.push_back({s % plates, "s"});
  touches.q.resize(count, model.robot.tree.coordinate_count());
  for (int i = 0; i < count;) {
    const int plate = i % plates;
    Touches one{touches.files, touches.sessions, {{plate, i % (sessions * plates), 0, i + 2}}, {}};
    one.q = TouchingPosture(model, random).transpose();
    const std::vector<int> joints =
        JointsToBody(model.robot.tree, model.robot.tree.links[model.setup.plates[plate].link].body);
    const Eigen::Vector3d wanted = Eigen::Vector3d(random.NormalVector(3, 1.0)).cwiseProduct(noise);
    Eigen::Vector3d left = LeftAt(model, one, truth) - wanted;
    for (int step = 0; step < 20 && left.norm() > 1e-14; ++step) {
      Eigen::Matrix3d J;
      for (int k = 0; k < 3; ++k) {
        const std::size_t from_hand[] = {1, 2, 4};  // wrist and shoulder
        const int joint = joints[joints.size() - from_hand[k]];
        Touches moved = one;
        moved.q(0, model.robot.tree.joints[joint].coordinate) += 1e-7;
        J.col(k) = (LeftAt(model, moved, truth) - wanted - left) / 1e-7;
      }
      const Eigen::Vector3d change = J.fullPivLu().solve(-left);
      for (int k = 0; k < 3; ++k) {
        const std::size_t from_hand[] = {1, 2, 4};
        const int joint = joints[joints.size() - from_hand[k]];
        one.q(0, model.robot.tree.joints[joint].coordinate) += change[k];
      }
      left = LeftAt(model, one, truth) - wanted;
    }
    if (!(left.norm() < 1e-12) || one.q.cwiseAbs().maxCoeff() > 2.5) continue;  // out of reach
    touches.touches.push_back(one.touches.front());
    touches.q.row(i++) = one.q;
  }
  return touches;
}

/// Truth of the invented robot: errors of these sizes, tables at the height of the hands.
inline ContactValues RandomTruth(const ContactModel& model, const ContactSpread& spread,
                                 int sessions, Random& random) {
  ContactValues truth;
  truth.robot = Eigen::VectorXd::Zero(model.robot.parameter_count());
  const std::vector<SourceOfParameter> sources = SourcesOfParameters(model);
  std::vector<double> drawn(static_cast<std::size_t>(model.unknown_count), 0.0);
  std::vector<char> done(drawn.size(), 0);
  for (int i = 0; i < model.robot.parameter_count(); ++i) {
    const int unknown = model.unknown[i];
    if (unknown < 0) continue;
    if (done[unknown] == 0) {
      drawn[unknown] = random.Normal(spread[sources[i].source] * sources[i].unit);
      if (IsCompliance(model.robot.parameters[i].kind)) drawn[unknown] = std::abs(drawn[unknown]);
      done[unknown] = 1;
    }
    truth.robot[i] = drawn[unknown];
  }
  for (std::size_t p = 0; p < model.setup.plates.size(); ++p) {
    truth.plate_tilts.emplace_back(random.NormalVector(2, spread[ContactSource::kPlateTilt]));
    TablePlane table;
    table.pivot = Eigen::Vector3d(0.4, p == 0 ? 0.1 : -0.3, 0.95);
    table.height_tilts << 0.0, random.NormalVector(2, spread[ContactSource::kTableTilt]);
    truth.tables.push_back(table);
  }
  for (std::size_t s = 0; s < sessions * model.setup.plates.size(); ++s) {
    Eigen::Vector3d effect;
    effect << random.Normal(spread[ContactSource::kSessionHeight]),
        random.NormalVector(2, spread[ContactSource::kSessionTilt]);
    truth.sessions.push_back(effect);
  }
  return truth;
}

}  // namespace elastocal
