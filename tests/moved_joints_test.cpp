// SPDX-License-Identifier: Apache-2.0
// A calibration as the prior of another one: what a few postures of another day tell about it, and
// the pattern of a wrong scale of the cameras.

#include "elastocal/validation/moved_joints.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/pipeline/earlier_calibration.hpp"
#include "elastocal/robot/zero_offset.hpp"
#include "elastocal/screening/camera_scale.hpp"
#include "tests/invented_arm.hpp"

namespace elastocal {
namespace {

const Eigen::Vector3d kInclined(0.28, 0.0, 0.0);  // rad

class KnownArm : public InventedArm {
 protected:
  /// Records with markers that are glued on anew each day.
  Recording Record(Eigen::VectorXd truth, int postures, std::uint64_t seed) const {
    truth += DrawErrors(model_, All(), {{ParameterKind::kMarker, 2e-3}}, seed);
    return MakeSyntheticRecording(model_, truth, {.postures = postures, .seed = seed});
  }

  CalibrationResult Fit(const Recording& recording, const CalibrationOptions& options = {}) const {
    return Calibrate(model_, recording, base_, ModelKind::kGeometric, options);
  }

  EarlierEstimate EstimateOf(const CalibrationResult& result) const {
    EarlierEstimate earlier;
    std::vector<int> rows, parameters;
    for (std::size_t i = 0; i < result.posterior.parameters.size(); ++i) {
      const int index = result.posterior.parameters[i];
      if (IsExternal(model_.parameters[index].kind)) continue;
      earlier.names.push_back(model_.parameters[index].name);
      rows.push_back(static_cast<int>(i));
      parameters.push_back(index);
    }
    earlier.mean = result.delta(parameters);
    earlier.covariance = result.posterior.covariance(rows, rows);
    return earlier;
  }

  struct CalibratedArm {
    std::uint64_t seed;
    Eigen::VectorXd truth;
    EarlierEstimate earlier;  ///< from thirty postures
  };
  CalibratedArm Calibrated(int robot) const {
    const auto seed = 10 * static_cast<std::uint64_t>(robot);
    const Eigen::VectorXd truth = Truth(robot);
    return {seed, truth, EstimateOf(Fit(Record(truth, 30, seed + 1)))};
  }

  JointCheck Check(const EarlierEstimate& earlier, const Recording& recording) const {
    const Eigen::VectorXd sizes = SizeOfChanges(earlier, model_, Prior());
    CalibrationOptions options;
    options.earlier = earlier;
    options.earlier.covariance.diagonal() += sizes.cwiseAbs2();
    return FindMovedJoints(Fit(recording, options), options.earlier, earlier, sizes);
  }

  double RobotError(const CalibrationResult& result, const Eigen::VectorXd& truth) const {
    // Error of the base parameters by their effect on the markers.
    const Recording other =
        MakeSyntheticRecording(model_, truth, {.postures = 40, .marker_sd = 0.0, .seed = 99});
    std::map<std::string, double> errors;
    for (int i = 0; i < model_.parameter_count(); ++i) {
      if (!IsExternal(model_.parameters[i].kind)) {
        errors[model_.parameters[i].name] = result.delta[i];
      }
    }
    return RefitExternals(model_, other, base_, {}, errors).marker_sd;
  }
};

TEST_F(KnownArm, OfNothingButThePriorChangesNothing) {
  const Recording recording = Record(Truth(1), 30, 1);
  CalibrationOptions options;
  options.widen_prior = false;
  const CalibrationResult plain = Fit(recording, options);
  const CalibrationResult start = plain;
  options.earlier = EstimateOf(start);
  options.earlier.mean.setZero();
  const Prior prior;
  Eigen::VectorXd variance(options.earlier.mean.size());
  for (Eigen::Index i = 0; i < variance.size(); ++i) {
    const int index =
        FindParameter(model_.parameters, options.earlier.names[static_cast<std::size_t>(i)]);
    variance[i] = std::pow(prior.Of(model_.tree, model_.parameters[index]), 2);
  }
  options.earlier.covariance = variance.asDiagonal();
  const CalibrationResult same = Fit(recording, options);
  EXPECT_LT((same.delta - plain.delta).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_LT(((same.sd - plain.sd).array() / plain.sd.array()).abs().maxCoeff(), 1e-6);
  EXPECT_LT((same.posterior.data_information - plain.posterior.data_information).norm(),
            1e-6 * plain.posterior.data_information.norm());
}

TEST_F(KnownArm, OfWhichNothingIsInDoubtIsKept) {
  CalibrationOptions options;
  options.earlier = EstimateOf(Fit(Record(Truth(2), 30, 2)));
  options.earlier.covariance *= 1e-8;
  const CalibrationResult later = Fit(Record(Truth(3), 12, 3), options);
  for (std::size_t i = 0; i < options.earlier.names.size(); ++i) {
    const int index = FindParameter(model_.parameters, options.earlier.names[i]);
    EXPECT_NEAR(later.delta[index], options.earlier.mean[static_cast<Eigen::Index>(i)], 1e-6)
        << options.earlier.names[i];
  }
}

// The first calibration, from a hundred postures, is updated by ten of another day.
TEST_F(KnownArm, UpdatedByTenPosturesIsNearlyAsGoodAsAllTogether) {
  double updated = 0.0, first = 0.0, few = 0.0;
  for (int robot = 0; robot < 10; ++robot) {
    const auto seed = 10 * static_cast<std::uint64_t>(robot);
    const Eigen::VectorXd truth = Truth(robot);
    const CalibrationResult start = Fit(Record(truth, 100, seed + 1));
    const Recording today = Record(truth, 10, seed + 2);
    CalibrationOptions options;
    options.earlier = EstimateOf(start);
    first += RobotError(start, truth);
    updated += RobotError(Fit(today, options), truth);
    few += RobotError(Fit(today), truth);
  }
  EXPECT_LE(updated, 1.01 * first);
  EXPECT_LT(updated, 0.9 * few);
  RecordProperty("first_nm", static_cast<int>(1e8 * first));
  RecordProperty("updated_nm", static_cast<int>(1e8 * updated));
  RecordProperty("few_nm", static_cast<int>(1e8 * few));
}

// Zeros may have drifted by a degree in all these days.
TEST_F(KnownArm, ZerosHaveDriftedForAsManyDaysAsTheDataAsk) {
  constexpr double kDays = 64.0;
  const Eigen::VectorXd truth = Truth(4);
  const EarlierEstimate earlier = EstimateOf(Fit(Record(truth, 30, 4)));
  std::vector<Eigen::Index> zeros;
  for (std::size_t i = 0; i < earlier.names.size(); ++i) {
    const int index = FindParameter(model_.parameters, earlier.names[i]);
    if (IsZeroOffset(model_.parameters[index], model_.tree) &&
        model_.parameters[index].unit == ParameterUnit::kRadian) {
      zeros.push_back(static_cast<Eigen::Index>(i));
    }
  }
  const auto after = [&](double days) {
    EarlierEstimate later = earlier;
    for (const Eigen::Index i : zeros) {
      later.covariance(i, i) += days / kDays * kDegree * kDegree;
    }
    return later;
  };
  const auto days_of = [&](const Eigen::VectorXd& now, double prior_sd_of_first) {
    CalibrationOptions options;
    options.earlier = after(kDays);
    CalibrationResult estimate = Fit(Record(now, 8, 5), options);
    if (!(prior_sd_of_first > 0.0)) prior_sd_of_first = estimate.prior_sd[0];
    estimate.prior_sd[0] = prior_sd_of_first;
    const EarlierEstimate known =
        MostProbable({}, estimate, options.earlier, kDays, after, Prior());
    const double added =
        known.covariance(zeros[0], zeros[0]) - earlier.covariance(zeros[0], zeros[0]);
    return kDays * added / (kDegree * kDegree);
  };
  Eigen::VectorXd drifted = truth;
  Random random(6);
  for (const Eigen::Index i : zeros) {
    drifted[FindParameter(model_.parameters, earlier.names[static_cast<std::size_t>(i)])] +=
        random.Normal(kDegree);
  }
  EXPECT_LE(days_of(truth, 0.0), 1.01);
  EXPECT_GE(days_of(drifted, 0.0), 15.9);
  // If nothing is known, the evidence is no number, and all days count.
  EXPECT_NEAR(days_of(truth, std::numeric_limits<double>::infinity()), kDays, 1e-6);
}

TEST_F(KnownArm, TheZeroOfASlidingJointIsALength) {
  const auto is_zero = [&](const char* name) {
    return IsZeroOffset(model_.parameters[FindParameter(model_.parameters, name)], model_.tree);
  };
  EXPECT_TRUE(is_zero("rail_joint.r"));
  EXPECT_FALSE(is_zero("rail_joint.theta"));
  EXPECT_TRUE(is_zero("elbow_joint.theta"));
  EXPECT_FALSE(is_zero("elbow_joint.r"));
}

TEST_F(KnownArm, EightPosturesTellWhichJointHasMoved) {
  constexpr int kRobots = 40;
  int named = 0, others = 0, false_alarms = 0, covered = 0;
  for (int robot = 0; robot < kRobots; ++robot) {
    const auto [seed, truth, earlier] = Calibrated(robot);
    false_alarms += Check(earlier, Record(truth, 8, seed + 2)).changed() ? 1 : 0;
    Eigen::VectorXd later = truth;
    later[FindParameter(model_.parameters, "elbow_joint.theta")] += 0.2 * kDegree;
    const JointCheck check = Check(earlier, Record(later, 8, seed + 2));
    for (const JointSuspect& joint : check.moved) {
      const bool is_it = joint.joint == "elbow_joint";
      (is_it ? named : others) += 1;
      if (!is_it) continue;
      const ParameterChange& change = joint.changes.front();
      EXPECT_EQ(change.name, "elbow_joint.theta");
      covered += std::abs(change.value - 0.2 * kDegree) < 2.2 * change.sd ? 1 : 0;
    }
  }
  EXPECT_GE(named, kRobots - 2);  // 19 of 20
  EXPECT_GE(covered, named - 4);
  EXPECT_LE(others, 2);
  EXPECT_LE(false_alarms, 5);  // 2 (5 %) are expected; the probability of 6 or more is 1 %
  RecordProperty("named", named);
  RecordProperty("false_alarms", false_alarms);
}

TEST(SmallestChange, IsWhatOutweighsTheOddsAndTheChoice) {
  // z^2 / 2 = log(2 . 7) + log 3 + log(1 + 100^2) / 2, plus 1.28 for a detection in nine of ten
  // cases.
  EXPECT_NEAR(SmallestChange(0.01, 1.0, 7), 0.01 * (4.085 + 1.28), 1e-5);
  EXPECT_TRUE(std::isinf(SmallestChange(2.0, 1.0, 7)));
}

TEST_F(KnownArm, TheSmallestChangeIsSeenNineTimesInTen) {
  constexpr int kRobots = 40;
  int seen = 0, of_half = 0;
  for (int robot = 0; robot < kRobots; ++robot) {
    const auto [seed, truth, earlier] = Calibrated(robot);
    const JointCheck before = Check(earlier, Record(truth, 8, seed + 2));
    const auto elbow = std::ranges::find(before.joints, "elbow_joint", &JointSuspect::joint);
    ASSERT_NE(elbow, before.joints.end());
    for (const double share : {1.0, 0.5}) {
      Eigen::VectorXd later = truth;
      later[FindParameter(model_.parameters, "elbow_joint.theta")] += share * elbow->smallest_seen;
      const bool changed = Check(earlier, Record(later, 8, seed + 3)).changed();
      (share == 1.0 ? seen : of_half) += changed ? 1 : 0;
    }
  }
  EXPECT_GE(seen, 30);     // 36 are expected, with a standard deviation of 2
  EXPECT_LE(of_half, 10);  // 3 are expected
  RecordProperty("seen", seen);
  RecordProperty("of_half", of_half);
}

// Each of them becomes more probable only when the others are known to have moved.
TEST_F(KnownArm, JointsThatMovedByTheSameAngleAreAllNamed) {
  int named = 0, others = 0;
  for (int robot = 0; robot < 10; ++robot) {
    const auto [seed, truth, earlier] = Calibrated(robot);
    Eigen::VectorXd later = truth;
    const std::vector<std::string> turned = {"shoulder_joint", "elbow_joint", "bend_joint"};
    for (const std::string& joint : turned) {
      later[FindParameter(model_.parameters, joint + ".theta")] += 0.3 * kDegree;
    }
    const JointCheck check = Check(earlier, Record(later, 8, seed + 2));
    EXPECT_TRUE(check.suspects.empty());
    for (const JointSuspect& joint : check.moved) {
      (std::ranges::count(turned, joint.joint) > 0 ? named : others) += 1;
      EXPECT_NEAR(joint.changes.front().value, 0.3 * kDegree, 4.0 * joint.changes.front().sd);
    }
  }
  EXPECT_EQ(named, 30);
  EXPECT_LE(others, 1);
}

// All its values are off by three times their standard deviations.
TEST_F(KnownArm, AnEarlierCalibrationThatIsTooSureAccusesNoJoint) {
  constexpr int kRobots = 20;
  int accused = 0, named = 0, widened = 0, sound = 0;
  for (int robot = 0; robot < kRobots; ++robot) {
    const auto seed = 10 * static_cast<std::uint64_t>(robot);
    const Eigen::VectorXd truth = Truth(robot);
    const EarlierEstimate right = EstimateOf(Fit(Record(truth, 30, seed + 1)));
    EarlierEstimate earlier = right;
    Random random(seed);
    const Eigen::MatrixXd L = earlier.covariance.llt().matrixL();
    earlier.mean += 3.0 * L * random.NormalVector(earlier.mean.size(), 1.0);
    const JointCheck same = Check(earlier, Record(truth, 8, seed + 2));
    accused += same.changed() ? 1 : 0;
    widened += same.widened >= 4.0 ? 1 : 0;
    sound += Check(right, Record(truth, 8, seed + 2)).widened <= 2.0 ? 1 : 0;
    Eigen::VectorXd later = truth;
    later[FindParameter(model_.parameters, "elbow_joint.theta")] += 1.0 * kDegree;
    const JointCheck check = Check(earlier, Record(later, 8, seed + 2));
    named += check.moved.size() == 1 && check.moved[0].joint == "elbow_joint" ? 1 : 0;
  }
  EXPECT_LE(accused, 2);
  EXPECT_GE(widened, kRobots - 2);
  EXPECT_GE(sound, kRobots - 2);
  EXPECT_GE(named, kRobots - 2);
  RecordProperty("accused", accused);
  RecordProperty("widened", widened);
  RecordProperty("sound", sound);
  RecordProperty("named", named);
}

// Errors of single lengths have no common pattern. A wrong scale of the cameras has one.
TEST_F(KnownArm, AWrongScaleOfAllPositionsIsToldFromErrorsOfSingleLengths) {
  constexpr int kRobots = 40;
  double squares = 0.0;
  int found = 0;
  for (std::uint64_t seed = 1; seed <= kRobots; ++seed) {
    const Eigen::VectorXd truth = Truth(static_cast<int>(seed));
    Recording recording = Record(truth, 30, seed);
    const auto clean = EstimateCommonScale(Fit(recording), {});
    ASSERT_TRUE(clean);
    squares += std::pow(clean->size / clean->sd, 2);
    EXPECT_FALSE(FindWrongScale(Fit(recording), {})) << seed;
    recording.markers *= 1.03;
    const auto wrong = EstimateCommonScale(Fit(recording), {});
    ASSERT_TRUE(wrong);
    EXPECT_LT(std::abs(wrong->size - 0.03), 4.5 * wrong->sd) << seed;
    found += FindWrongScale(Fit(recording), {}) ? 1 : 0;
  }
  EXPECT_GE(found, kRobots - 2);
  // Deviations in standard deviations; chi-square of 40 exceeds each bound with a probability of
  // one in a thousand.
  EXPECT_GT(squares / kRobots, 0.45);
  EXPECT_LT(squares / kRobots, 1.85);
}

// The elbow's axis is inclined to the shoulder's by 16 degrees in their common plane. Many robots
// have such axes at their shoulders. The axes meet at least half a metre away. Real errors of the
// places and directions of joints move that point by centimetres.
TEST_F(KnownArm, InclinedAxesLookLikeNoScale) {
  constexpr int kRobots = 40;
  RobotTree tree = model_.tree;
  Joint& elbow = tree.joints[static_cast<std::size_t>(FindJoint(tree, "elbow_joint"))];
  elbow.T_parent_child.linear() = RotationFromVector(kInclined) * elbow.T_parent_child.linear();
  // By default, a joint with such axes has beta and no far common normal.
  const PlacementOptions far_normals{.longest_lever_m = 1e9};
  const ErrorModel nominal = MakeErrorModel(tree, model_.markers, far_normals);
  double furthest = 0.0;
  for (const JointPlacement& placement : nominal.placements) {
    furthest = std::max(furthest, std::abs(placement.r));
  }
  ASSERT_GT(furthest, 0.5);
  const BaseParameters base = FindBaseParameters(nominal, {});
  double squares = 0.0;
  int found = 0;
  for (std::uint64_t seed = 1; seed <= kRobots; ++seed) {
    Random random(seed);
    RobotTree displaced = tree;
    for (Joint& joint : displaced.joints) {
      joint.T_parent_child.translation() += random.NormalVector(3, 1e-3);
      joint.T_parent_child.linear() =
          joint.T_parent_child.linear() * RotationFromVector(random.NormalVector(3, 0.5 * kDegree));
    }
    const ErrorModel robot = MakeErrorModel(displaced, model_.markers, far_normals);
    Recording recording = MakeSyntheticRecording(
        robot, Eigen::VectorXd::Zero(robot.parameter_count()), {.postures = 30, .seed = seed});
    const auto fit = [&] { return Calibrate(nominal, recording, base, ModelKind::kGeometric, {}); };
    const auto clean = EstimateCommonScale(fit(), {});
    ASSERT_TRUE(clean);
    squares += std::pow(clean->size / clean->sd, 2);
    EXPECT_FALSE(FindWrongScale(fit(), {})) << seed;
    recording.markers *= 1.06;
    found += FindWrongScale(fit(), {}) ? 1 : 0;
  }
  EXPECT_GE(found, kRobots / 2);
  EXPECT_GT(squares / kRobots, 0.45);
  EXPECT_LT(squares / kRobots, 1.85);
  RecordProperty("mean_square_percent", static_cast<int>(100.0 * squares / kRobots));
}

}  // namespace
}  // namespace elastocal
