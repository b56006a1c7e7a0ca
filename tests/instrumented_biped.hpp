// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/touching_biped.hpp"

namespace elastocal {

/// The touching biped with one instrument of each kind.
struct InstrumentedBiped {
  enum Stance { kOnFeet, kFixed };  ///< fixed: the root link is held still, and nothing is touched
  enum Kinds {
    kImages = 64,
    kPlates = 1,
    kPoses = 2,
    kInertial = 4,
    kTips = 8,
    kWires = 16,
    kPoints = 32,
    kAll = 127
  };

  explicit InstrumentedBiped(Stance stance, int kinds = kAll,
                             const std::vector<std::string>& hold = {})
      : on_feet(stance == kOnFeet) {
    RobotTree tree;
    ObservationSetup setup = TouchingSetup(tree);
    if (!on_feet || (kinds & kPlates) == 0) {
      ObservationSetup without;
      if (on_feet) without.feet = setup.feet;
      setup = without;
    }
    const int left = FindLink(tree, "arm_left_5_link");
    const int right = FindLink(tree, "arm_right_5_link");
    const int trunk = FindLink(tree, "trunk_pitch_link");
    if (kinds & (kPoses | kPoints)) {
      const Tracker room = AddTracker(setup, "room");
      if (kinds & kPoses) {
        Transform T_link = RotX(0.4) * RotZ(0.7);
        T_link.translation() << 0.05, -0.02, 0.03;
        AddTrackedBody(setup, {.name = "hand", .link = left, .T_link = T_link, .tracker = room});
        // A body that the trunk's tracker sees, with its own covariance.
        const Tracker head = AddTracker(setup, "head", trunk);
        Eigen::MatrixXd covariance = 1e-6 * Eigen::MatrixXd::Identity(6, 6);
        covariance(0, 4) = covariance(4, 0) = 5e-7;
        covariance(3, 3) = 4e-6;
        AddTrackedBody(
            setup,
            {.name = "other_hand", .link = right, .tracker = head, .covariance = covariance});
      }
      if (kinds & kPoints) {
        for (int m = 0; m < 3; ++m) {
          const Eigen::Vector3d p(0.05 * m, m == 1 ? 0.06 : -0.02, m == 2 ? 0.07 : 0.01);
          AddTrackedPoint(
              setup,
              {.name = "marker" + std::to_string(m), .link = right, .p_link = p, .tracker = room});
        }
      }
    }
    if (kinds & kInertial) {
      AddInertialUnit(setup, {.name = "imu", .link = 0, .R_link_unit = RotX(0.3).linear()});
      AddInertialUnit(setup, {.name = "hand_imu", .link = left});
    }
    if (kinds & kTips) {
      const int wall = AddPlane(setup, "wall", {1.0, 0.2, 0.1});
      AddPlaneDistance(setup,
                       {.name = "tip", .link = left, .p_link = {0.1, 0.0, 0.02}, .plane = wall});
      AddPlaneDistance(setup, {.name = "gauge",
                               .link = trunk,
                               .p_link = {0.1, 0.1, 0.3},
                               .plane = AddPlane(setup, "ground")});
    }
    if (kinds & kWires) {
      AddWire(
          setup,
          {.name = "wire", .link = right, .p_link = {0.03, 0.0, 0.0}, .p_floor = {1.5, -0.6, 0.2}});
    }
    if (kinds & kImages) AddCameras(setup, trunk, left, right);
    model = MakeTouchingBiped(tree, setup, hold);
  }

  /// Adds a camera on the trunk and one in the room, which see tags on both hands. One also sees a
  /// fixed tag.
  static void AddCameras(ObservationSetup& setup, int trunk, int left, int right) {
    CameraSetup head{.name = "camera", .link = trunk};
    head.camera = {620.0, 610.0, 320.0, 240.0, 0.08, -0.05, 2e-3, -1e-3, 0.01};
    // The camera looks ahead and downwards.
    head.T_parent = RotZ(-0.5 * M_PI) * RotX(-0.5 * M_PI - 0.7);
    head.T_parent.translation() << 0.05, 0.0, 0.55;
    CameraSetup room{.name = "room_camera"};
    room.camera = {500.0, 500.0, 400.0, 300.0};
    room.T_parent = RotZ(0.5 * M_PI) * RotX(-0.5 * M_PI - 0.2);
    room.T_parent.translation() << 2.5, -0.1, 1.2;
    const MountedCamera cameras[] = {AddCamera(setup, head), AddCamera(setup, room)};
    TagSetup back{.name = "back", .link = left, .size = 0.06};
    back.T_parent = RotY(-0.8);
    TagSetup top{.name = "top", .link = right, .size = 0.06};
    top.T_parent = RotY(0.9) * RotZ(0.3);
    TagSetup stand{.name = "stand", .size = 0.1};
    stand.T_parent.translation() << 0.6, 0.1, 0.7;
    const MountedTag tags[] = {AddTag(setup, back), AddTag(setup, top), AddTag(setup, stand)};
    for (const MountedCamera& camera : cameras) {
      for (const MountedTag& tag : tags) {
        if (camera.of.link >= 0 || tag.of.link >= 0) AddSeenTag(setup, camera, tag);
      }
    }
  }

  bool touches() const { return !model.setup.plates.empty(); }

  /// Measurements of the true robot without noise.
  Observations Observe(const ObservedValues& truth, int touch_count, int posture_count,
                       Random& random) const {
    Observations all;
    all.files = {"synthetic"};
    if (touches()) {
      const int sessions = static_cast<int>(truth.effects.size() / model.setup.plates.size());
      all = SimulateTouches(model, truth, touch_count, sessions, Eigen::Vector3d::Zero(), random);
    }
    AddMeasurements(model, truth, posture_count, all, random);
    return all;
  }

  bool on_feet;
  ObservedRobot model;
};

/// Adds normal noise to all measurements, with the standard deviations of their sources.
inline void AddNoise(const ObservedRobot& model, Observations& observations, Random& random) {
  for (Observation& of : observations.all) {
    const Instrument& instrument = model.instrument(of.instrument);
    if (of.measured.size() == 0) continue;
    const Eigen::MatrixXd factor = instrument.Weights(FirstSpread(model.setup.sources)).inverse();
    const Eigen::VectorXd noise = factor * random.NormalVector(instrument.size(), 1.0);
    if (of.measured.size() != 7) {
      of.measured += noise;
      continue;
    }
    of.measured.head<3>() += noise.head<3>();
    const Eigen::Quaterniond attitude(of.measured[6], of.measured[3], of.measured[4],
                                      of.measured[5]);
    const Eigen::Vector3d turn = noise.tail<3>();
    const Eigen::Quaterniond turned =
        attitude * Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
    of.measured.tail<4>() = turned.coeffs();
  }
}

}  // namespace elastocal
