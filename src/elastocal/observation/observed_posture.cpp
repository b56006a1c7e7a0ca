// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/observed_posture.hpp"

#include <optional>
#include <stdexcept>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/robot/posture_loads.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {
namespace {

/// Pose of a tracker by the points that it sees; nothing for fewer than `fewest`.
std::optional<Transform> Register(const Instrument::Landmarks& landmarks, std::size_t fewest) {
  if (landmarks.size() < fewest) return std::nullopt;
  Eigen::Matrix3Xd here(3, std::ssize(landmarks));
  Eigen::Matrix3Xd there = here;
  for (Eigen::Index i = 0; i < here.cols(); ++i) {
    here.col(i) = landmarks[static_cast<std::size_t>(i)].first;
    there.col(i) = landmarks[static_cast<std::size_t>(i)].second;
  }
  return FitRigid(there, here);
}

/// Effect of a session on the numbers of a pose (QuantityValue::Pose) with this origin.
Eigen::VectorXd EffectOf(const Transform& pose, const Transform& origin) {
  Eigen::VectorXd effect(6);
  const Eigen::Matrix3d turn = pose.linear() * origin.linear().transpose();
  effect << pose.translation() - origin.translation(), RotationVector(turn);
  return effect;
}

/// Moves the origins of trackers' poses to those that the nominal robot suggests. A tracker that
/// differs between sessions gets the pose of the session in which it saw most points; the effects
/// of the other sessions are set likewise.
void RegisterTrackers(const ObservedRobot& model, const Observations& observations,
                      const std::vector<Sight>& sights, ObservedValues& values) {
  // Points; with fewer, the session is taken as the others.
  constexpr std::size_t kFewestOfSession = 8;
  std::vector<Instrument::Landmarks> fixed(values.quantities.size());  // without effect
  std::vector<Instrument::Landmarks> of_effects(observations.effects.size());
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const Observation& observation = observations.all[i];
    const Instrument& instrument = model.instrument(observation.instrument);
    const int quantity = instrument.quantities.front();
    bool varies = false;
    for (const int effect : observation.effects) {
      if (observations.effects[Size(effect)].quantity != quantity) continue;
      varies = true;
      instrument.AddLandmarks(sights[i], observation.measured, of_effects[Size(effect)]);
    }
    if (!varies) instrument.AddLandmarks(sights[i], observation.measured, fixed[Size(quantity)]);
  }
  for (std::size_t q = 0; q < fixed.size(); ++q) {
    const Instrument::Landmarks* most = &fixed[q];
    for (std::size_t e = 0; e < of_effects.size() && fixed[q].empty(); ++e) {
      const bool own = observations.effects[e].quantity == static_cast<int>(q);
      if (own && of_effects[e].size() > most->size()) most = &of_effects[e];
    }
    const auto pose = Register(*most, 1);
    if (pose) values.quantities[q].origin = *pose;
  }
  for (std::size_t e = 0; e < of_effects.size(); ++e) {
    const QuantityValue& quantity = values.quantities[Size(observations.effects[e].quantity)];
    const auto pose = Register(of_effects[e], kFewestOfSession);
    if (pose) values.effects[e] = EffectOf(*pose, quantity.origin);
  }
}

}  // namespace

void ObservedPosture::Evaluate(const Geometry& geometry, const ObservedValues& values,
                               const Eigen::VectorXd& q, const JointLoads& loads) {
  jacobian_.Evaluate(geometry, q, loads);
  if (model_.root_tilt < 0) {
    RootOnFeet root = PlaceRootOnFeet(Feet());
    T_floor_root_ = root.T_floor_root;
    by_foot_ = std::move(root.by_foot);
    return;
  }
  const Eigen::VectorXd& tilts = values.quantities[model_.root_tilt].x;
  T_floor_root_ = RotX(tilts[0]) * RotY(tilts[1]);
  by_tilt_.col(0).head<3>() = Eigen::Vector3d::UnitX();
  by_tilt_.col(1).head<3>() = RotX(tilts[0]).linear().col(1);
}

std::vector<StandingFoot> ObservedPosture::Feet() const {
  std::vector<StandingFoot> feet;
  for (std::size_t i = 0; i < model_.setup.feet.size(); ++i) {
    const ContactFoot& foot = model_.setup.feet[i];
    feet.push_back({jacobian_.LegPose(static_cast<int>(i)), foot.T_floor_foot, foot.share});
  }
  return feet;
}

Sight ObservedPosture::SightOf(const Observations& observations, const Observation& observation,
                               const ObservedValues& values) const {
  const Instrument& instrument = model_.instrument(observation.instrument);
  Sight sight;
  for (int link : instrument.links) {
    const int leg = model_.leg_of_link[link];
    sight.T_floor_link.push_back(T_floor_root_ * (leg < 0
                                                      ? model_.robot.tree.links[link].T_body_link
                                                      : jacobian_.LegPose(leg)));
  }
  for (int quantity : instrument.quantities) {
    sight.values.push_back(values.quantities[quantity]);
    for (int effect : observation.effects) {
      if (observations.effects[effect].quantity != quantity || values.effects.empty()) continue;
      sight.values.back().x += values.effects[effect];
    }
  }
  return sight;
}

std::vector<JointLoads> ObservedLoads(const ObservedRobot& model, const Observations& observations,
                                      const Eigen::VectorXd& errors) {
  const Geometry geometry = ApplyErrors(model.robot, errors);
  GeneralizedJacobian jacobian(model.robot);
  std::vector<int> links;
  for (const ContactFoot& foot : model.setup.feet) links.push_back(foot.link);
  std::vector<JointLoads> loads;
  for (int i = 0; i < observations.posture_count(); ++i) {
    const Eigen::VectorXd q = observations.q.row(i);
    JointLoads load;
    for (int step = 0; step < 2; ++step) {  // first for the rigid, then for the deflected robot
      if (links.empty()) {
        load = GravityLoads(model.robot, geometry, q, kGravity, 0, load);
        continue;
      }
      jacobian.Evaluate(geometry, q, load);
      std::vector<StandingFoot> feet;
      for (std::size_t f = 0; f < links.size(); ++f) {
        const ContactFoot& foot = model.setup.feet[f];
        feet.push_back({jacobian.LegPose(static_cast<int>(f)), foot.T_floor_foot, foot.share});
      }
      load = SharedSupportLoads(model.robot, geometry, q, links, feet, load);
    }
    if (!model.robot.elasticity.corrections.empty()) {
      if (links.empty()) {
        load.by_correction = LoadsByCorrections(model.robot, geometry, q, kGravity);
      }
      PostureHistory history;
      if (observations.approach.rows() > 0) history.approach = observations.approach.row(i);
      AddShapes(model.robot, geometry, q, kGravity, history, load);
    }
    loads.push_back(std::move(load));
  }
  return loads;
}

std::vector<Sight> SightsOf(const ObservedRobot& model, const Observations& observations,
                            const ObservedValues& values, const std::vector<JointLoads>& loads) {
  if (values.quantities.size() != model.setup.quantities.size()) {
    throw std::invalid_argument("as many quantities as the model has");
  }
  const Geometry geometry = ApplyErrors(model.robot, values.robot);
  ObservedPosture posture(model);
  std::vector<Sight> sights(observations.all.size());
  for (int i = 0; i < observations.posture_count(); ++i) {
    posture.Evaluate(geometry, values, observations.q.row(i),
                     loads.empty() ? JointLoads() : loads[static_cast<std::size_t>(i)]);
    for (std::size_t k = 0; k < sights.size(); ++k) {
      if (observations.all[k].posture != i) continue;
      sights[k] = posture.SightOf(observations, observations.all[k], values);
    }
  }
  return sights;
}

ObservedValues NominalValues(const ObservedRobot& model, const Observations& observations) {
  ObservedValues values;
  values.robot = Eigen::VectorXd::Zero(model.robot.parameter_count());
  for (const Quantity& quantity : model.setup.quantities) {
    values.quantities.push_back({quantity.origin, Eigen::VectorXd::Zero(quantity.size())});
  }
  for (const SessionEffect& effect : observations.effects) {
    values.effects.emplace_back(
        Eigen::VectorXd::Zero(model.setup.quantities[effect.quantity].size()));
  }
  const std::vector<Sight> sights = SightsOf(model, observations, values, {});
  RegisterTrackers(model, observations, sights, values);
  for (std::size_t n = 0; n < model.setup.instruments.size(); ++n) {
    std::vector<Sight> own;
    std::vector<Eigen::VectorXd> measured;
    for (std::size_t i = 0; i < sights.size(); ++i) {
      if (observations.all[i].instrument != static_cast<int>(n)) continue;
      own.push_back(sights[i]);
      measured.push_back(observations.all[i].measured);
    }
    if (own.empty()) continue;
    std::vector<QuantityValue*> of;
    for (int quantity : model.setup.instruments[n]->quantities) {
      of.push_back(&values.quantities[quantity]);
    }
    model.setup.instruments[n]->Begin(own, measured, of);
  }
  return values;
}

std::vector<Eigen::VectorXd> LeftOf(const ObservedRobot& model, const Observations& observations,
                                    const ObservedValues& values) {
  if (values.robot.size() != model.robot.parameter_count()) {
    throw std::invalid_argument("LeftOf: the values are of another model of the robot");
  }
  const std::vector<Sight> sights =
      SightsOf(model, observations, values, ObservedLoads(model, observations, values.robot));
  std::vector<Eigen::VectorXd> left;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const Observation& observation = observations.all[i];
    left.push_back(
        model.instrument(observation.instrument).Evaluate(sights[i], observation.measured).left);
  }
  return left;
}

}  // namespace elastocal
