// SPDX-License-Identifier: Apache-2.0
#include "tests/standing_humanoid.hpp"

#include <cmath>
#include <limits>

#include "elastocal/math/random.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

int FindLinkIndex(const RobotTree& tree, const std::string& name) {
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    if (tree.links[i].name == name) return static_cast<int>(i);
  }
  throw std::runtime_error("no link " + name);
}

/// Sets a leg to yaw, roll, pitch, knee, ankle pitch and ankle roll.
void SetLeg(const RobotTree& tree, const std::string& side, const std::vector<double>& values,
            Eigen::VectorXd& q) {
  for (const Joint& joint : tree.joints) {
    const std::string prefix = "leg_" + side + "_";
    if (!joint.name.starts_with(prefix)) continue;
    q[joint.coordinate] = values[static_cast<std::size_t>(joint.name[prefix.size()] - '1')];
  }
}

std::vector<double> Standing(Random& random) {
  const double knee = random.Uniform(0.4, 1.0);
  const double lean = random.Uniform(-0.15, 0.15);
  const double sway = random.Uniform(-0.12, 0.12);
  return {random.Uniform(-0.1, 0.1), sway, -0.5 * knee + lean, knee, -0.5 * knee - lean, -sway};
}

std::vector<double> Swinging(Random& random, double outwards) {
  return {random.Uniform(-0.3, 0.3), outwards * random.Uniform(0.0, 0.4),
          random.Uniform(-1.2, 0.2), random.Uniform(0.2, 1.6),
          random.Uniform(-0.7, 0.4), random.Uniform(-0.35, 0.35)};
}

PlayedTrial Play(const RobotTree& tree, const std::string& chain, int postures, Random& random) {
  PlayedTrial played;
  played.trial.name = chain;
  played.trial.chains = {chain};
  const bool left = chain == "leg_left";
  const bool leg = left || chain == "leg_right";
  if (!left) played.trial.support.push_back(FindLinkIndex(tree, "left_sole_link"));
  if (chain != "leg_right") {
    played.trial.support.push_back(FindLinkIndex(tree, "right_sole_link"));
  }
  played.q.resize(postures, tree.coordinate_count());
  for (int i = 0; i < postures; ++i) {
    Eigen::VectorXd q = 0.7 * RandomPosture(tree, random);
    const std::vector<double> standing = Standing(random);
    SetLeg(tree, "left", standing, q);
    SetLeg(tree, "right", standing, q);
    if (leg) SetLeg(tree, left ? "left" : "right", Swinging(random, left ? 1.0 : -1.0), q);
    played.q.row(i) = q.transpose();
  }
  return played;
}

}  // namespace

StandingHumanoid::StandingHumanoid(int postures, std::uint64_t seed, bool torque_bias)
    : project(ReadProject(SourceFile("models/talos/project.yaml"))) {
  Elasticity elasticity;
  elasticity.torque_bias = torque_bias;
  for (std::size_t k = 0; k < project.tree.joints.size(); ++k) {
    const std::string& name = project.tree.joints[k].name;
    if (name.starts_with("torso_") || name.starts_with("arm_")) {
      elasticity.torsion.push_back(static_cast<int>(k));
    }
  }
  for (const Chain& chain : project.chains) {
    if (chain.name.starts_with("leg_")) elasticity.legs.push_back({chain.name, chain.tip_link});
  }
  model = MakeErrorModel(project.tree, project.markers, project.placement, elasticity);
  base = FindBaseParameters(model, project.identifiability);
  Random random(seed);
  for (const char* chain :
       {"head_trunk", "torso_arm_left", "torso_arm_right", "leg_left", "leg_right"}) {
    trials.push_back(Play(project.tree, chain, postures, random));
  }
}

Eigen::VectorXd StandingHumanoid::DrawTruth(std::uint64_t seed) const {
  const double angle = 0.5 * M_PI / 180.0;
  Random random(seed);
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(model.parameter_count());
  for (int i = 0; i < model.parameter_count(); ++i) {
    const Parameter& parameter = model.parameters[i];
    switch (parameter.kind) {
      case ParameterKind::kWaistPose:
        break;
      case ParameterKind::kMarker:
        truth[i] = random.Normal(0.01);
        break;
      case ParameterKind::kTorsion:
        truth[i] = random.Uniform(2e-6, 3e-5);
        break;
      case ParameterKind::kLegForce:
        truth[i] = random.Uniform(2e-6, 9e-6);
        break;
      case ParameterKind::kLegMoment:
        truth[i] = random.Uniform(2e-6, 5e-5);
        break;
      case ParameterKind::kTorqueBias:
        truth[i] = random.Normal(1.0);
        break;
      default:
        truth[i] = random.Normal(parameter.unit == ParameterUnit::kRadian ? angle : 1e-3);
    }
  }
  return truth;
}

Recording StandingHumanoid::Record(const Eigen::VectorXd& truth,
                                   const StandingOptions& options) const {
  Recording recording = MakeStandingRecording(model, truth, trials, options);
  for (int m = 0; m < model.marker_count(); ++m) {
    const int link = model.markers[m].link;
    const int body = project.tree.links[link].body;
    for (int i = 0; i < recording.posture_count(); ++i) {
      const Trial& trial = recording.trials[recording.trial[i]];
      bool seen = body == 0;
      for (int support : trial.support) seen = seen || project.tree.links[support].body == body;
      for (const Chain& chain : project.chains) {
        if (chain.name != trial.chains[0]) continue;
        for (int joint : JointsToBody(project.tree, project.tree.links[chain.tip_link].body)) {
          seen = seen || joint + 1 == body;
        }
      }
      if (!seen) {
        recording.markers.block<1, 3>(i, 3 * m).setConstant(
            std::numeric_limits<double>::quiet_NaN());
      }
    }
  }
  return recording;
}

}  // namespace elastocal
