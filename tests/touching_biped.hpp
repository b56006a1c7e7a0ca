// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/math/random.hpp"
#include "elastocal/observation/observation_fit.hpp"
#include "tests/biped.hpp"

namespace elastocal {

/// Adds an arm of five joints to a trunk, on the side of y = `side`. Returns its hand.
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

/// The biped on both feet with two arms, each of which has a plate under its hand.
inline ObservationSetup TouchingSetup(RobotTree& tree) {
  tree = MakeBiped().tree;
  const int trunk = FindLink(tree, "trunk_pitch_link");
  ObservationSetup setup;
  for (const char* side : {"left", "right"}) {
    const double y = side[0] == 'l' ? 1.0 : -1.0;
    const int hand = AddArm(tree, std::string("arm_") + side, trunk, y);
    AddPlate(setup, {side, hand, {Eigen::Vector3d(0.1, 0, -0.03), RotZ(0.3).linear()}});
    setup.feet.push_back(
        {FindLink(tree, std::string(side) + "_sole"), Offset(0, 0.085 * (y - 1), 0)});
  }
  return setup;
}

/// The biped's model with some joints that give way (for a held root: only one of them). `hold`:
/// patterns of parameters.
inline ObservedRobot MakeTouchingBiped(const RobotTree& tree, ObservationSetup setup,
                                       const std::vector<std::string>& hold = {}) {
  setup.hold = hold;
  if (setup.feet.empty()) {
    return MakeObservedRobot(tree, {}, setup, {FindJoint(tree, "arm_left_2")}, {});
  }
  setup.common = {{"left_3.compliance_z", "right_3.compliance_z"}};
  const std::vector<int> torsion = {FindJoint(tree, "left_3"), FindJoint(tree, "right_3"),
                                    FindJoint(tree, "arm_left_2")};
  return MakeObservedRobot(tree, {}, setup, torsion, {FindJoint(tree, "left_3")});
}

inline ObservedRobot MakeTouchingBiped(const std::vector<std::string>& hold = {}) {
  RobotTree tree;
  const ObservationSetup setup = TouchingSetup(tree);
  return MakeTouchingBiped(tree, setup, hold);
}

/// A posture with bent knees and with the hands in front.
inline Eigen::VectorXd TouchingPosture(const ObservedRobot& model, Random& random) {
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

/// Touches of a robot with the errors `truth`, in random postures. Newton's method moves three
/// joints of the touching arm until the plate has the height and tilts that `noise` draws. The
/// plates alternate, and so do the `sessions` sessions of each plate. `above`: additional heights
/// of the first touches over the table, m.
inline Observations SimulateTouches(const ObservedRobot& model, const ObservedValues& truth,
                                    int count, int sessions, const Eigen::Vector3d& noise,
                                    Random& random, const std::vector<double>& above = {}) {
  Observations touches;
  touches.files = {"synthetic"};
  const int plates = static_cast<int>(model.setup.plates.size());
  for (int s = 0; s < sessions * plates; ++s) {
    touches.effects.push_back({model.instrument(s % plates).quantities[1], "s"});
  }
  touches.q.resize(count, model.robot.tree.coordinate_count());
  for (int i = 0; i < count;) {
    const int plate = i % plates;
    Observations one{touches.files, touches.effects, {{0, i + 2}}, {}, {}};
    one.all.push_back({0, plate, {}, {i % (sessions * plates)}});
    one.q = TouchingPosture(model, random).transpose();
    const std::vector<int> joints =
        JointsToBody(model.robot.tree, model.robot.tree.links[model.setup.plates[plate].link].body);
    Eigen::Vector3d wanted = Eigen::Vector3d(random.NormalVector(3, 1.0)).cwiseProduct(noise);
    if (static_cast<std::size_t>(i) < above.size()) wanted[0] += above[static_cast<std::size_t>(i)];
    const auto left_of = [&](const Observations& of) {
      return Eigen::Vector3d(LeftOf(model, of, truth)[0] - wanted);
    };
    Eigen::Vector3d left = left_of(one);
    constexpr std::size_t kFromHand[] = {1, 2, 4};  // from the hand: wrist and shoulder
    for (int step = 0; step < 20 && left.norm() > 1e-14; ++step) {
      Eigen::Matrix3d J;
      for (int k = 0; k < 3; ++k) {
        const int joint = joints[joints.size() - kFromHand[k]];
        Observations moved = one;
        moved.q(0, model.robot.tree.joints[joint].coordinate) += 1e-7;
        J.col(k) = (left_of(moved) - left) / 1e-7;
      }
      const Eigen::Vector3d change = J.fullPivLu().solve(-left);
      for (int k = 0; k < 3; ++k) {
        const int joint = joints[joints.size() - kFromHand[k]];
        one.q(0, model.robot.tree.joints[joint].coordinate) += change[k];
      }
      left = left_of(one);
    }
    if (!(left.norm() < 1e-12) || one.q.cwiseAbs().maxCoeff() > 2.5) continue;  // out of reach
    touches.postures.push_back(one.postures.front());
    touches.all.push_back(one.all.front());
    touches.all.back().posture = i;
    touches.q.row(i++) = one.q;
  }
  return touches;
}

/// A random truth of the invented robot. Errors and quantities have the sizes of their sources (0.1
/// if nothing is known), and so have effects of sessions. Tables are at the height of the hands.
inline ObservedValues RandomTruth(const ObservedRobot& model, int sessions, Random& random) {
  const Spread spread = FirstSpread(model.setup.sources);
  ObservedValues truth;
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
  for (const Quantity& quantity : model.setup.quantities) {
    QuantityValue value{quantity.origin, Eigen::VectorXd::Zero(quantity.size())};
    for (int k = 0; k < quantity.size(); ++k) {
      value.x[k] = random.Normal(std::min(0.1, spread[quantity.sources[k]]));
    }
    truth.quantities.push_back(value);
  }
  for (std::size_t p = 0; p < model.setup.plates.size(); ++p) {
    QuantityValue& table = truth.quantities[model.instrument(static_cast<int>(p)).quantities[1]];
    table.origin.translation() << 0.4, p == 0 ? 0.1 : -0.3, 0.95;
    table.x[0] = 0.0;
  }
  for (std::size_t s = 0; s < sessions * model.setup.plates.size(); ++s) {
    Eigen::VectorXd effect(3);
    effect << random.Normal(spread[kSessionHeight]), random.NormalVector(2, spread[kSessionTilt]);
    truth.effects.push_back(effect);
  }
  return truth;
}

/// Adds measurements without noise of all instruments but the plates, in `count` postures of the
/// true robot with random arms.
inline void AddMeasurements(const ObservedRobot& model, const ObservedValues& truth, int count,
                            Observations& observations, Random& random) {
  const int first = observations.posture_count();
  const int plates = static_cast<int>(model.setup.plates.size());
  observations.q.conservativeResize(first + count, model.robot.tree.coordinate_count());
  for (int i = first; i < first + count; ++i) {
    observations.postures.push_back({0, i + 2});
    observations.q.row(i) = TouchingPosture(model, random).transpose();
    for (const Joint& joint : model.robot.tree.joints) {
      if (joint.name.starts_with("arm_")) {
        observations.q(i, joint.coordinate) += random.Uniform(-1.2, 1.2);
      }
    }
    for (int n = plates; n < static_cast<int>(model.setup.instruments.size()); ++n) {
      observations.all.push_back({i, n, {}, {}});
    }
  }
  const std::vector<Sight> sights =
      SightsOf(model, observations, truth, ObservedLoads(model, observations, truth.robot));
  for (std::size_t i = 0; i < sights.size(); ++i) {
    Observation& of = observations.all[i];
    if (of.instrument >= plates && of.measured.size() == 0) {
      if (!model.instrument(of.instrument).Sees(sights[i])) continue;
      of.measured = model.instrument(of.instrument).Predict(sights[i]);
    }
  }
  std::erase_if(observations.all, [&](const Observation& of) {
    return of.instrument >= plates && of.measured.size() == 0;
  });
}

}  // namespace elastocal
