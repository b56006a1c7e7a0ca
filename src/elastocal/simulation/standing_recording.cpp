#include "elastocal/simulation/standing_recording.hpp"

#include <limits>

#include "elastocal/math/random.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/robot/leg_load.hpp"
#include "elastocal/robot/posture_loads.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {
namespace {

constexpr int kSteps = 12;       // of the loads' fixed point; each gains two digits or more
constexpr double kSway = 0.003;  // m and rad

int SupportingLeg(const ErrorModel& model, const Trial& trial) {
  for (int leg = 0; leg < model.leg_count(); ++leg) {
    if (trial.support.size() == 1 && model.legs[leg].link == trial.support[0]) return leg;
  }
  return -1;
}

Transform RandomPose(double metres, double radians, Random& random) {
  Transform T = Transform::Identity();
  T.translation() = random.NormalVector(3, metres);
  T.linear() = RotationFromVector(random.NormalVector(3, radians));
  return T;
}

/// One posture at rest: the waist where its loaded leg carries it.
class Pose {
 public:
  Pose(const ErrorModel& model, const Eigen::VectorXd& delta, const Eigen::VectorXd& q,
       const StandingOptions& options)
      : model_(model), geometry_(ApplyErrors(model, delta)), q_(q), options_(options) {}

  void StandOn(int leg, const Transform& T_ref_foot, const Eigen::Vector3d& gravity) {
    Transform T_ref_waist =
        T_ref_foot * LinkTransforms(model_.tree, q_)[model_.legs[leg].link].inverse();
    for (int step = 0; step < kSteps; ++step) {
      PlaceWaist(T_ref_waist, Vector6d::Zero(), geometry_);
      Feel(leg, gravity);
      const LegPosture rigid = PlaceLeg(model_, geometry_, q_, leg, loads_.joints);
      const Vector6d wrench = loads_.WaistLoad(model_, geometry_, leg);
      T_ref_waist =
          T_ref_foot *
          DeflectWaist(rigid.T_foot_waist, geometry_.leg_compliance[leg], wrench).T_foot_waist;
    }
  }
  void StandAt(const Transform& T_ref_waist, const Eigen::Vector3d& gravity) {
    PlaceWaist(T_ref_waist, Vector6d::Zero(), geometry_);
    for (int step = 0; step < kSteps; ++step) Feel(-1, gravity);
  }
  /// Those on the foot that stands, which does not move, are where it is.
  Eigen::Matrix3Xd Markers(int leg, const Transform& T_ref_foot) const {
    Eigen::Matrix3Xd positions = MarkerPositions(model_, geometry_, q_, loads_.joints);
    for (int m = 0; leg >= 0 && m < model_.marker_count(); ++m) {
      const int foot = model_.legs[leg].link;
      const auto body = [&](int link) { return model_.tree.links[link].body; };
      if (body(model_.markers[m].link) != body(foot)) continue;
      positions.col(m) = T_ref_foot * PlaceMarker(model_, geometry_, m, foot).position;
    }
    return positions;
  }
  const Eigen::VectorXd& torques() const { return torques_; }

 private:
  /// Torques of the robot as it is deflected now, and the loads that follow from them.
  void Feel(int leg, const Eigen::Vector3d& gravity) {
    const JointLoads load =
        GravityLoads(model_, geometry_, q_, gravity, leg < 0 ? 0 : model_.legs[leg].link);
    torques_.setConstant(static_cast<Eigen::Index>(model_.tree.joints.size()),
                         std::numeric_limits<double>::quiet_NaN());
    for (int joint : options_.torque_sensors) {
      torques_[joint] = geometry_.torque_bias[joint] - load(2, joint);
    }
    Felt felt;
    felt.torques = torques_;
    loads_ = LoadPosture(model_, geometry_, q_, leg, felt, gravity, {});
  }

  const ErrorModel& model_;
  Geometry geometry_;
  Eigen::VectorXd q_;
  const StandingOptions& options_;
  PostureLoads loads_;
  Eigen::VectorXd torques_;
};

}  // namespace

Recording MakeStandingRecording(const ErrorModel& model, const Eigen::VectorXd& delta,
                                const std::vector<PlayedTrial>& trials,
                                const StandingOptions& options) {
  Random random(options.seed);
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
    const int leg = SupportingLeg(model, played.trial);
    Transform T_ref_foot = RandomPose(0.5, 0.0, random);
    T_ref_foot.linear() = RotZ(random.Normal(1.0)).linear();
    for (Eigen::Index i = 0; i < played.q.rows(); ++i, ++row) {
      Pose pose(model, delta, played.q.row(i).transpose(), options);
      if (leg >= 0) {
        pose.StandOn(leg, T_ref_foot, recording.gravity);
      } else {
        const bool held = played.trial.support.empty();
        pose.StandAt(held ? T_ref_foot : T_ref_foot * RandomPose(kSway, kSway, random),
                     recording.gravity);
      }
      recording.q.row(row) = played.q.row(i);
      recording.markers.row(row) =
          pose.Markers(leg, T_ref_foot).reshaped().transpose() +
          random.NormalVector(3 * model.marker_count(), options.marker_sd).transpose();
      recording.torques.row(row) =
          pose.torques().transpose() +
          random.NormalVector(pose.torques().size(), options.torque_sd).transpose();
      recording.trial.push_back(static_cast<int>(recording.trials.size()));
    }
    recording.trials.push_back(played.trial);
  }
  return recording;
}

}  // namespace elastocal
