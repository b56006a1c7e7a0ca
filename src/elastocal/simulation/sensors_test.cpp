// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/sensors.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/simulation/virtual_experiment.hpp"
#include "tests/biped.hpp"

namespace elastocal {
namespace {

constexpr int kFrames = 6000;

/// A minute in which joints and markers move as sines, independently of any robot.
class Sensors : public testing::Test {
 protected:
  Sensors() {
    const Biped biped = MakeBiped();
    robot_ = NominalRobot(biped.tree, biped.markers, FindLegs(biped.tree, biped.chains), {1, 5});
    clusters_ = {{"WAIST", {0, 1, 2}}, {"TRUNK", {3, 4, 5}}};
    for (const char* name : {"first", "second"}) {
      PlannedTrial trial;
      trial.name = name;
      const Eigen::VectorXd a = Eigen::VectorXd::Zero(biped.tree.coordinate_count());
      const Eigen::VectorXd b = Eigen::VectorXd::Ones(biped.tree.coordinate_count());
      for (int i = 0; i < 6; ++i) {
        trial.motion.segments.push_back({.duration_s = 4.0, .from = a, .to = b});
        trial.motion.segments.push_back({.duration_s = 1.0, .from = b, .to = b});
        trial.motion.segments.push_back({.duration_s = 4.0, .from = b, .to = a});
        trial.motion.segments.push_back({.duration_s = 1.0, .from = a, .to = a});
      }
      trials_.push_back(trial);
    }
    for (const Marker& marker : biped.markers) motion_.marker_names.push_back(marker.name);
    for (const Joint& joint : biped.tree.joints) motion_.joint_names.push_back(joint.name);
    motion_.markers.resize(kFrames, 3 * static_cast<Eigen::Index>(biped.markers.size()));
    motion_.encoders.resize(kFrames, biped.tree.coordinate_count());
    motion_.torques.resize(kFrames, biped.tree.coordinate_count());
    for (Eigen::Index i = 0; i < kFrames; ++i) {
      const double s = Position(static_cast<double>(i) / 100.0);
      for (std::size_t m = 0; m < biped.markers.size(); ++m) {
        motion_.markers.row(i).segment<3>(3 * static_cast<Eigen::Index>(m)) =
            (RotZ(s) * biped.markers[m].p_link_marker).transpose();
      }
      motion_.encoders.row(i).setConstant(s);
      motion_.torques.row(i).setConstant(100.0 * s);
    }
    VirtualExperimentOptions perfect;
    SwitchOffImperfections(perfect);
    options_ = perfect.sensors;
  }

  static double Position(double time_s) { return 0.8 * std::sin(M_PI * time_s); }

  RawTrial Measured(const Faults& faults = {}, std::size_t trial = 0) const {
    return Measure(robot_, clusters_, trials_, trial, motion_, options_, faults);
  }

  /// Number of positions of a marker that are missing or differ from the truth by more than a
  /// micrometre.
  int Changed(const RawTrial& raw, int marker, Eigen::Index from = 0,
              Eigen::Index to = kFrames) const {
    int count = 0;
    for (Eigen::Index i = from; i < to; ++i) {
      const double error =
          (raw.markers.positions.row(i) - motion_.markers.row(i)).segment<3>(3 * marker).norm();
      if (!(error < 1e-6)) ++count;
    }
    return count;
  }

  TrueRobot robot_;
  std::vector<NamedCluster> clusters_;
  std::vector<PlannedTrial> trials_;
  TrueMotion motion_;
  SensorOptions options_;
};

TEST_F(Sensors, PerfectOnesShowTheTruth) {
  const RawTrial raw = Measured();
  EXPECT_EQ(raw.markers.positions, motion_.markers);
  EXPECT_EQ(raw.joints.sample_count(), kFrames);
  // The log has 1e-8 rad and 1e-4 N.m as last digits.
  EXPECT_LT((raw.joints.positions - motion_.encoders).cwiseAbs().maxCoeff(), 0.51e-8);
  EXPECT_LT((raw.joints.torques - motion_.torques).col(1).cwiseAbs().maxCoeff(), 0.51e-4);
  EXPECT_TRUE(raw.joints.torques.col(0).array().isNaN().all()) << "no sensor there";
  EXPECT_TRUE(raw.truth.faults.empty());
}

TEST_F(Sensors, NoiseAndOutliersAreAsLargeAndAsManyAsTold) {
  options_.marker_noise_sd = 0.2e-3;
  options_.outlier_share = 1e-3;
  const Eigen::MatrixXd error = Measured().markers.positions - motion_.markers;
  int outliers = 0;
  double sum = 0.0;
  Eigen::Index clean = 0;
  for (const double e : error.reshaped()) {
    if (std::abs(e) > 1.5e-3) continue;
    sum += e * e;
    ++clean;
  }
  for (Eigen::Index i = 0; i < kFrames; ++i) {
    for (Eigen::Index m = 0; m < error.cols(); m += 3) {
      if (error.row(i).segment<3>(m).norm() > 3e-3) ++outliers;
    }
  }
  EXPECT_NEAR(std::sqrt(sum / static_cast<double>(clean)), 0.2e-3, 0.02e-3);
  EXPECT_NEAR(outliers, 72, 30);  // of 72 000 samples; 3.5 standard deviations
}

TEST_F(Sensors, GapsAndSwapsComeAsOftenAsTold) {
  options_.gaps_per_minute = 6.0;
  options_.mean_gap_s = 0.5;
  const Eigen::MatrixXd& gappy = Measured().markers.positions;
  const double missing =
      static_cast<double>(gappy.array().isNaN().count()) / static_cast<double>(gappy.size());
  EXPECT_NEAR(missing, 6.0 * 0.5 / 60.0, 0.02);  // 72 gaps scatter by 14 %
  options_.gaps_per_minute = 0.0;
  options_.swaps_per_minute = 10.0;
  const RawTrial swapped = Measured();
  const int moved = Changed(swapped, 0) + Changed(swapped, 1) + Changed(swapped, 2);
  EXPECT_GT(moved, 0);
  EXPECT_EQ(Changed(swapped, 6), 0) << "no cluster";
  // The three positions are exchanged and otherwise unchanged.
  const Eigen::RowVectorXd sum = swapped.markers.positions.leftCols(9).rowwise().sum().transpose() -
                                 motion_.markers.leftCols(9).rowwise().sum().transpose();
  EXPECT_LT(sum.cwiseAbs().maxCoeff(), 1e-12);
}

TEST_F(Sensors, TheLogRunsOnItsOwnClock) {
  options_.least_lag_s = options_.largest_lag_s = 2.5;
  options_.drift_size_ppm = 1000.0;
  const RawTrial raw = Measured();
  EXPECT_EQ(raw.truth.lag_s, 2.5);
  EXPECT_NE(raw.truth.drift_ppm, 0.0);
  EXPECT_EQ(raw.joints.time_s[0], 0.0);
  for (Eigen::Index i = 0; i < raw.joints.time_s.size(); i += 100) {
    const double camera_s = (raw.joints.time_s[i] + 2.5) / (1.0 + 1e-6 * raw.truth.drift_ppm);
    // Cubic interpolation between the truth's samples.
    if (camera_s < 59.9) {
      EXPECT_NEAR(raw.joints.positions(i, 0), Position(camera_s), 1e-6);
    }
  }
}

TEST_F(Sensors, EncodersCountAndTorqueSensorsErr) {
  options_.encoder_bits = 12;
  robot_.torque_gain[5] = 1.05;
  robot_.torque_bias[5] = -2.0;
  const RawTrial raw = Measured();
  const double step = 2.0 * M_PI / 4096.0;
  const Eigen::ArrayXd error = (raw.joints.positions.col(0) - motion_.encoders.col(0)).array();
  EXPECT_LE(error.abs().maxCoeff(), 0.5 * step + 1e-8);
  EXPECT_GT(error.abs().maxCoeff(), 0.4 * step);
  EXPECT_LT((raw.joints.torques.col(5) - (1.05 * motion_.torques.col(5).array() - 2.0).matrix())
                .cwiseAbs()
                .maxCoeff(),
            1e-4);
  options_.torque_noise_sd = 0.3;
  const Eigen::ArrayXd noise = (Measured().joints.torques.col(1) - motion_.torques.col(1)).array();
  EXPECT_NEAR(std::sqrt(noise.square().mean()), 0.3, 0.02);
}

TEST_F(Sensors, FaultMissingShareAndLostMarker) {
  Faults faults;
  faults.missing_share = 0.05;
  const Eigen::MatrixXd& positions = Measured(faults).markers.positions;
  EXPECT_NEAR(static_cast<double>(positions.array().isNaN().count()) /
                  static_cast<double>(positions.size()),
              0.05, 0.004);
  faults = {};
  faults.lost_marker = "TRUNK_2";
  const RawTrial raw = Measured(faults);
  EXPECT_EQ(Changed(raw, 4, 0, kFrames / 2), 0);
  EXPECT_EQ(Changed(raw, 4), kFrames / 2);
  EXPECT_EQ(Changed(raw, 3), 0);
  EXPECT_EQ(raw.truth.faults.size(), 1u);
}

TEST_F(Sensors, FaultSwappedLabels) {
  Faults faults;
  faults.swapped_marker_a = "WAIST_1";
  faults.swapped_marker_b = "WAIST_3";
  faults.trial = "second";
  EXPECT_EQ(Changed(Measured(faults, 0), 0), 0) << "in the second trial only";
  const RawTrial raw = Measured(faults, 1);
  EXPECT_EQ(Changed(raw, 0), 2000) << "20 s";
  EXPECT_EQ(Changed(raw, 1), 0);
  EXPECT_EQ((raw.markers.positions.block(3000, 0, 1, 3)), motion_.markers.block(3000, 6, 1, 3));
  EXPECT_EQ((raw.markers.positions.block(3000, 6, 1, 3)), motion_.markers.block(3000, 0, 1, 3));
}

TEST_F(Sensors, FaultKnockedClusterStaysKnocked) {
  Faults faults;
  faults.knocked_cluster = "TRUNK";
  faults.trial = "first";
  const RawTrial first = Measured(faults, 0);
  EXPECT_EQ(Changed(first, 3, 0, kFrames / 2), 0);
  EXPECT_EQ(Changed(first, 3), kFrames / 2);
  EXPECT_EQ(Changed(first, 0), 0);
  const RawTrial second = Measured(faults, 1);
  EXPECT_EQ(Changed(second, 4), kFrames);
  const auto shift = [&](Eigen::Index frame) -> Eigen::RowVectorXd {
    return (second.markers.positions - motion_.markers).row(frame).segment(9, 9);
  };
  EXPECT_NEAR(shift(0).head<3>().norm(), 5e-3, 1e-12);
  EXPECT_LT((shift(0).head<3>() - shift(0).tail<3>()).norm(), 1e-12) << "all three alike";
  // The displacement is fixed to the link and turns with it.
  const Eigen::Vector3d turned =
      RotZ(Position(0.3)) * Eigen::Vector3d(shift(0).head<3>().transpose());
  EXPECT_LT((turned.transpose() - shift(30).head<3>()).norm(), 1e-9);
}

TEST_F(Sensors, FaultsOfTorqueSensorsAndLog) {
  Faults faults;
  faults.dead_torque_sensor = robot_.tree.joints[1].name;
  faults.saturated_torque_sensor = robot_.tree.joints[5].name;
  faults.saturation = 30.0;
  faults.log_cut_s = 10.0;
  faults.lag_s = 4.0;
  const RawTrial raw = Measured(faults);
  EXPECT_TRUE(raw.joints.torques.col(1).isZero());
  EXPECT_EQ(raw.joints.torques.col(5).maxCoeff(), 30.0);
  EXPECT_EQ(raw.joints.torques.col(5).minCoeff(), -30.0);
  EXPECT_EQ(raw.truth.lag_s, 4.0);
  EXPECT_NEAR(raw.joints.time_s.tail<1>()[0], 59.99 - 4.0 - 10.0, 0.011);
  EXPECT_EQ(raw.truth.faults.size(), 3u);
}

TEST_F(Sensors, FaultSlippedFootMovesAllInOnePosture) {
  Faults faults;
  faults.slipped_posture = 2;  // motions end at 4, 9, 14 s...
  const RawTrial raw = Measured(faults);
  EXPECT_EQ(Changed(raw, 0, 0, 800), 0);
  EXPECT_EQ(Changed(raw, 0, 800, 1300), 500);
  EXPECT_EQ(Changed(raw, 11, 800, 1300), 500);
  EXPECT_EQ(Changed(raw, 0, 1300, kFrames), 0);
  EXPECT_NEAR((raw.markers.positions - motion_.markers).row(950).segment<3>(0).norm(), 3e-3, 1e-12);
}

TEST_F(Sensors, FaultsMustNameWhatIsThere) {
  const auto message = [&](auto&& set) -> std::string {
    Faults faults;
    set(faults);
    try {
      Measured(faults);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message([](Faults& f) { f.lost_marker = "TRUNK_7"; }),
            "fault: there is no marker 'TRUNK_7'; did you mean 'TRUNK_1'?");
  EXPECT_NE(message([](Faults& f) { f.knocked_cluster = "LFOOT"; }), "");
  EXPECT_NE(message([](Faults& f) { f.dead_torque_sensor = "left_1"; }), "");
  EXPECT_NE(message([](Faults& f) { f.swapped_marker_a = "WAIST_1"; }), "");
  EXPECT_NE(message([](Faults& f) { f.trial = "third"; }), "");
}

}  // namespace
}  // namespace elastocal
