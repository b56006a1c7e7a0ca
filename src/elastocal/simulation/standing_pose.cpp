// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/standing_pose.hpp"

#include <limits>

#include "elastocal/robot/leg_load.hpp"
#include "elastocal/robot/posture_loads.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {
namespace {

constexpr int kMostSteps = 12;  // steps of the fixed point; each gains two digits or more
constexpr double kAtRest =
    1e-9;  // N.m: smaller changes of loads move nothing by more than rounding

class FixedPoint {
 public:
  FixedPoint(const ErrorModel& model, const Geometry& geometry, const Eigen::VectorXd& q,
             const Eigen::Vector3d& gravity_ref, const std::vector<int>& torque_sensors)
      : model_(model),
        geometry_(geometry),
        q_(q),
        gravity_ref_(gravity_ref),
        torque_sensors_(torque_sensors) {}

  void StandOn(int leg, const Transform& T_ref_foot) {
    Hold(T_ref_foot * LinkTransforms(model_.tree, q_)[Foot(leg)].inverse());
    for (int step = 0; step < kMostSteps; ++step) {
      const bool at_rest = Feel(leg);
      const LegPosture rigid = PlaceLeg(model_, geometry_, q_, leg, loads_.joints);
      const Vector6d wrench = loads_.WaistLoad(model_, geometry_, leg);
      Hold(T_ref_foot *
           DeflectWaist(rigid.T_foot_waist, geometry_.leg_compliance[leg], wrench).T_foot_waist);
      if (at_rest) break;
    }
    TakePose();
    for (int m = 0; m < model_.marker_count(); ++m) {
      if (Body(model_.markers[m].link) != Body(Foot(leg))) continue;
      pose.markers.col(m) = T_ref_foot * PlaceMarker(model_, geometry_, m, Foot(leg)).position;
    }
  }

  void StandAt(const Transform& T_ref_waist) {
    Hold(T_ref_waist);
    for (int step = 0; step < kMostSteps; ++step) {
      if (Feel(-1)) break;
    }
    TakePose();
  }

  StandingPose pose;

 private:
  int Foot(int leg) const { return model_.legs[leg].link; }
  int Body(int link) const { return model_.tree.links[link].body; }

  void Hold(const Transform& T_ref_waist) {
    PlaceWaist(T_ref_waist, Vector6d::Zero(), geometry_);
    pose.T_ref_waist = T_ref_waist;
  }

  /// Computes the torques of the robot as it is deflected now, and the loads by them. Returns
  /// whether they are those of the step before.
  bool Feel(int leg) {
    const JointLoads load =
        GravityLoads(model_, geometry_, q_, gravity_ref_, leg < 0 ? 0 : Foot(leg), loads_.joints);
    const bool at_rest =
        load_.size() == load.size() && (load - load_).cwiseAbs().maxCoeff() < kAtRest;
    load_ = load;
    pose.torques.setConstant(static_cast<Eigen::Index>(model_.tree.joints.size()),
                             std::numeric_limits<double>::quiet_NaN());
    for (int joint : torque_sensors_) {
      const double bias = geometry_.torque_bias.size() > 0 ? geometry_.torque_bias[joint] : 0.0;
      pose.torques[joint] = bias - load(2, joint);
    }
    MeasuredLoads measured;
    measured.torques = pose.torques;
    loads_ = LoadPosture(model_, geometry_, q_, leg, measured, gravity_ref_, {});
    return at_rest;
  }

  void TakePose() { pose.markers = MarkerPositions(model_, geometry_, q_, loads_.joints); }

  const ErrorModel& model_;
  Geometry geometry_;
  const Eigen::VectorXd& q_;
  const Eigen::Vector3d gravity_ref_;
  const std::vector<int>& torque_sensors_;
  PostureLoads loads_;
  JointLoads load_;
};

}  // namespace

int SupportingLeg(const ErrorModel& model, const std::vector<int>& support) {
  for (int leg = 0; leg < model.leg_count(); ++leg) {
    if (support.size() == 1 && model.legs[leg].link == support[0]) {
      return leg;
    }
  }
  return -1;
}

StandingPose StandOnLeg(const ErrorModel& model, const Geometry& geometry, const Eigen::VectorXd& q,
                        int leg, const Transform& T_ref_foot, const Eigen::Vector3d& gravity_ref,
                        const std::vector<int>& torque_sensors) {
  FixedPoint point(model, geometry, q, gravity_ref, torque_sensors);
  point.StandOn(leg, T_ref_foot);
  return point.pose;
}

StandingPose HoldWaist(const ErrorModel& model, const Geometry& geometry, const Eigen::VectorXd& q,
                       const Transform& T_ref_waist, const Eigen::Vector3d& gravity_ref,
                       const std::vector<int>& torque_sensors) {
  FixedPoint point(model, geometry, q, gravity_ref, torque_sensors);
  point.StandAt(T_ref_waist);
  return point.pose;
}

}  // namespace elastocal
