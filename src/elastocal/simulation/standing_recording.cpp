// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/standing_recording.hpp"

#include "elastocal/math/random.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/simulation/standing_pose.hpp"

namespace elastocal {
namespace {

constexpr double kSway = 0.003;  // m and rad

Transform RandomPose(double metres, double radians, Random& random) {
  Transform T = Transform::Identity();
  T.translation() = random.NormalVector(3, metres);
  T.linear() = RotationFromVector(random.NormalVector(3, radians));
  return T;
}

}  // namespace

Recording MakeStandingRecording(const ErrorModel& model, const Eigen::VectorXd& delta,
                                const std::vector<PlayedTrial>& trials,
                                const StandingOptions& options) {
  Random random(options.seed);
  const Geometry geometry = ApplyErrors(model, delta);
  Recording recording;
  recording.source = "synthetic recording";
  for (const Marker& marker : model.markers) recording.marker_names.push_back(marker.name);
  Eigen::Index count = 0;
  for (const PlayedTrial& played : trials) count += played.q.rows();
  recording.q.resize(count, model.tree.coordinate_count());
  recording.markers.resize(count, 3 * model.marker_count());
  recording.torques.resize(count, static_cast<Eigen::Index>(model.tree.joints.size()));
  Eigen::Index row = 0;
  for (const PlayedTrial& played : trials) {
    const int leg = SupportingLeg(model, played.trial.support);
    Transform T_ref_foot = RandomPose(0.5, 0.0, random);
    T_ref_foot.translation().z() = 0.0;  // one floor
    T_ref_foot.linear() = RotZ(random.Normal(1.0)).linear();
    for (Eigen::Index i = 0; i < played.q.rows(); ++i, ++row) {
      const Eigen::VectorXd q = played.q.row(i).transpose();
      StandingPose pose;
      if (leg >= 0) {
        pose = StandOnLeg(model, geometry, q, leg, T_ref_foot, recording.gravity,
                          options.torque_sensors);
      } else {
        const bool held = played.trial.support.empty();
        pose = HoldWaist(model, geometry, q,
                         held ? T_ref_foot : T_ref_foot * RandomPose(kSway, kSway, random),
                         recording.gravity, options.torque_sensors);
      }
      recording.q.row(row) = played.q.row(i);
      recording.markers.row(row) =
          pose.markers.reshaped().transpose() +
          random.NormalVector(3 * model.marker_count(), options.marker_sd).transpose();
      recording.torques.row(row) =
          pose.torques.transpose() +
          random.NormalVector(pose.torques.size(), options.torque_sd).transpose();
      recording.trial.push_back(static_cast<int>(recording.trials.size()));
    }
    recording.trials.push_back(played.trial);
  }
  return recording;
}

}  // namespace elastocal
