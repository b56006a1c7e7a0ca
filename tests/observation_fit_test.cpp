// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/observation_fit.hpp"

#include <Eigen/QR>
#include <gtest/gtest.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/observation/observation_figures.hpp"
#include "tests/instrumented_biped.hpp"

namespace elastocal {
namespace {

constexpr double kDegreeOfArc = M_PI / 180.0;

double Largest(const std::vector<Eigen::VectorXd>& left) {
  double largest = 0.0;
  for (const Eigen::VectorXd& of : left) largest = std::max(largest, of.cwiseAbs().maxCoeff());
  return largest;
}

/// Fits data without noise.
ObservationFit FitExactly(const ObservedRobot& model, const Observations& seen) {
  ObservationFit start = StartFit(model, seen);
  for (std::size_t s = 0; s < model.setup.sources.size(); ++s) {
    if (model.setup.sources[s].role != Source::Role::kNoise) continue;
    // With less noise, rounding would drown the weak information of gravity. A pixel is about 2
    // mrad, so that 1e-6 of it is finer than 1e-7 m or rad.
    switch (model.setup.sources[s].unit) {
      case SourceUnit::kNone:
        start.spread.sd[s] = 1e-4;
        break;
      case SourceUnit::kPixel:
        start.spread.sd[s] = 1e-6;
        break;
      default:
        start.spread.sd[s] = 1e-7;
    }
  }
  return FitObservations(model, seen, start, {.estimate_spread = false, .max_updates = 6});
}

TEST(ObservationFit, PredictsOtherTouchesExactlyAfterTouchesWithoutNoise) {
  const ObservedRobot model = MakeTouchingBiped({"*.compliance_*"});
  Random random(11);
  const ObservedValues truth = RandomTruth(model, 1, random);
  const Observations seen = SimulateTouches(model, truth, 60, 1, Eigen::Vector3d::Zero(), random);
  const Observations others = SimulateTouches(model, truth, 10, 1, Eigen::Vector3d::Zero(), random);
  // 180 numbers determine everything that touches depend on.
  const ObservationFit fit = FitExactly(model, seen);
  EXPECT_LT(Largest(LeftOf(model, others, fit.values)), 1e-8);
}

/// Each kind of instrument alone, and all together, on feet and with a held root.
class EveryKind : public testing::TestWithParam<std::pair<InstrumentedBiped::Stance, int>> {};

TEST_P(EveryKind, IsPredictedExactlyAfterMeasurementsWithoutNoise) {
  const InstrumentedBiped biped(GetParam().first, GetParam().second, {"*.compliance_*"});
  Random random(21);
  const ObservedValues truth = RandomTruth(biped.model, biped.touches() ? 1 : 0, random);
  const Observations seen = biped.Observe(truth, 40, 160, random);
  const Observations others = biped.Observe(truth, 4, 10, random);
  const ObservationFit fit = FitExactly(biped.model, seen);
  EXPECT_LT(Largest(LeftOf(biped.model, others, fit.values)), 1e-8);
}

constexpr auto kOnFeet = InstrumentedBiped::kOnFeet;
constexpr auto kFixed = InstrumentedBiped::kFixed;
INSTANTIATE_TEST_SUITE_P(ObservationFit, EveryKind,
                         testing::Values(std::pair(kOnFeet, InstrumentedBiped::kPoses),
                                         std::pair(kOnFeet, InstrumentedBiped::kInertial),
                                         std::pair(kOnFeet, InstrumentedBiped::kTips),
                                         std::pair(kOnFeet, InstrumentedBiped::kWires),
                                         std::pair(kOnFeet, InstrumentedBiped::kPoints),
                                         std::pair(kOnFeet, InstrumentedBiped::kImages),
                                         std::pair(kOnFeet, InstrumentedBiped::kAll),
                                         std::pair(kFixed, InstrumentedBiped::kAll)));

/// Number of independent parameters of the robot that the observations determine besides all
/// quantities, without the prior.
int RankOfRobot(const InstrumentedBiped& biped, const Observations& observations) {
  ObservationFit fit = StartFit(biped.model, observations);
  ObservationResiduals residuals(biped.model, observations, fit.loads, fit.spread, fit.weights, {},
                                 fit.values);
  residuals.Evaluate(residuals.Start(), true);
  std::vector<Eigen::Index> first = {0};
  for (int size : residuals.parameter_blocks) first.push_back(first.back() + size);
  Eigen::Index rows = 0;
  for (const Observation& of : observations.all) {
    rows += biped.model.instrument(of.instrument).size();
  }
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows, first.back());
  rows = 0;
  for (int i = 0; i < observations.count(); ++i) {
    const auto& block = residuals.Jacobian(i);
    Eigen::Index column = 0;
    for (int of : residuals.residual_blocks[i].parameter_blocks) {
      J.block(rows, first[of], block.rows(), residuals.parameter_blocks[of]) =
          block.middleCols(column, residuals.parameter_blocks[of]);
      column += residuals.parameter_blocks[of];
    }
    rows += block.rows();
  }
  const auto rank = [](Eigen::MatrixXd columns) {
    for (Eigen::Index c = 0; c < columns.cols(); ++c) {
      const double norm = columns.col(c).norm();
      if (norm > 0.0) columns.col(c) /= norm;
    }
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
    qr.setThreshold(1e-9);
    return static_cast<int>(qr.rank());
  };
  const Eigen::Index robot = biped.model.unknown_count;
  return rank(J) - rank(J.rightCols(J.cols() - robot));
}

TEST(ObservationFit, TouchesAndInertialUnitsDetermineMoreThanEither) {
  const std::vector<std::string> rigid = {"*.compliance_*"};
  const auto rank = [&](int kinds) {
    const InstrumentedBiped biped(kOnFeet, kinds, rigid);
    Random random(31);
    const ObservedValues truth = RandomTruth(biped.model, biped.touches() ? 1 : 0, random);
    return RankOfRobot(biped, biped.Observe(truth, 60, 60, random));
  };
  const int touches = rank(InstrumentedBiped::kPlates);
  const int units = rank(InstrumentedBiped::kInertial);
  const int both = rank(InstrumentedBiped::kPlates | InstrumentedBiped::kInertial);
  RecordProperty("touches", touches);
  RecordProperty("units", units);
  RecordProperty("both", both);
  EXPECT_GT(both, touches) << touches << " " << units << " " << both;
  EXPECT_GT(both, units) << touches << " " << units << " " << both;
}

// Each corner has noise of half a pixel, and each tag is off by 2 px as a whole in each image.
TEST(ObservationFit, WhatTheCornersOfATagShareIsTold) {
  const InstrumentedBiped biped(kOnFeet, InstrumentedBiped::kImages, {"*.compliance_*"});
  const ObservedRobot& model = biped.model;
  Random random(19);
  const ObservedValues truth = RandomTruth(model, 0, random);
  Observations seen = biped.Observe(truth, 0, 80, random);
  AddNoise(model, seen, random);
  for (Observation& of : seen.all) {
    const Eigen::VectorXd shift = random.NormalVector(2, 2.0);
    of.measured += shift.replicate(4, 1);
  }
  const ObservationFit fit = EstimateObserved(model, seen, {}).fit;
  for (std::size_t s = 0; s < model.setup.sources.size(); ++s) {
    const Source& source = model.setup.sources[s];
    if (source.unit != SourceUnit::kPixel) continue;
    const bool shared = source.name.ends_with(".shared");
    // The source is that of the mean, which is twice the shift.
    EXPECT_NEAR(fit.spread.sd[s], shared ? 4.0 : 0.5, shared ? 0.8 : 0.1) << source.name;
  }
}

TEST(ObservationFit, TheMountingOfAnInertialUnitIsFoundWithItsUncertainty) {
  // An offset of the joint that carries the unit acts like a turned mounting, so that angles are
  // known here.
  const InstrumentedBiped biped(kOnFeet, InstrumentedBiped::kInertial | InstrumentedBiped::kTips,
                                {"*.compliance_*", "*.theta", "*.alpha", "*.beta", "*.gamma"});
  const ObservedRobot& model = biped.model;
  const auto find = [&](const std::string& name) {
    int unit = 0;
    while (model.setup.quantities[unit].name != name) ++unit;
    return unit;
  };
  const int hand = find("hand_imu.mounting");
  double squares = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Random random(40 + seed);
    ObservedValues truth = RandomTruth(model, 0, random);
    truth.quantities[hand].x.head<3>() << 0.4, -0.3, 1.2;  // far from the project's values
    Observations seen = biped.Observe(truth, 0, 150, random);
    AddNoise(model, seen, random);
    const ObservationFit fit = EstimateObserved(model, seen, {}).fit;
    EXPECT_TRUE(fit.settled);
    for (int unit : {hand, find("imu.mounting")}) {
      const Eigen::Vector3d error = RotationVector(
          truth.quantities[unit].Rotation(0) * fit.values.quantities[unit].Rotation(0).transpose());
      // 0.02 m/s^2 are 0.12 degrees. Each of 150 postures tells two of three angles, and the bias
      // is estimated as well: 0.012 degrees for each angle, or up to twice that.
      if (unit == hand) {
        EXPECT_LT(error.norm(), 0.05 * kDegreeOfArc);
      }
      const int entry = fit.entry_of_quantity[unit];
      // The left Jacobian of the chart's rotation vector gives the turn of the axes.
      const Eigen::Matrix3d turns = fit.values.quantities[unit].Turns(0);
      const Eigen::Matrix3d covariance =
          turns * fit.covariance.block<3, 3>(entry, entry) * turns.transpose();
      squares += error.dot(covariance.llt().solve(error));
      count += 3;
    }
  }
  // Chi-squared of 36 numbers is 36 +- 8.5. The bounds are three times that.
  EXPECT_GT(squares, 11.0);
  EXPECT_LT(squares, 61.0) << "of " << count;
}

TEST(ObservationFit, ThePoseOfACameraLiesInItsInterval) {
  const InstrumentedBiped biped(kOnFeet, InstrumentedBiped::kImages, {"*.compliance_*"});
  const ObservedRobot& model = biped.model;
  int camera = 0;
  while (model.setup.quantities[camera].name != "camera.mounting") ++camera;
  double squares = 0.0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Random random(60 + seed);
    const ObservedValues truth = RandomTruth(model, 0, random);
    Observations seen = biped.Observe(truth, 0, 60, random);
    AddNoise(model, seen, random);
    const ObservationFit fit = EstimateObserved(model, seen, {}).fit;
    EXPECT_TRUE(fit.settled);
    const int entry = fit.entry_of_quantity[camera];
    const Eigen::VectorXd error = fit.values.quantities[camera].x - truth.quantities[camera].x;
    squares += error.dot(fit.covariance.block(entry, entry, 6, 6).llt().solve(error));
  }
  // Chi-squared of 36 numbers is 36 +- 8.5. The bounds are three times that. (The camera's pose
  // begins at nominal, so that both charts are the same.)
  EXPECT_GT(squares, 11.0);
  EXPECT_LT(squares, 61.0);
}

// With few images, the unknown pose of each tag explains the rows that its corners share. This does
// not mean that images have no noise.
TEST(ObservationFit, NoiseIsNotTakenForNoneWhereUnknownsExplainItsRows) {
  const InstrumentedBiped biped(kOnFeet, InstrumentedBiped::kImages, {"*.compliance_*"});
  const std::vector<Source>& sources = biped.model.setup.sources;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Random random(80 + seed);
    const ObservedValues truth = RandomTruth(biped.model, 0, random);
    Observations seen = biped.Observe(truth, 0, 12, random);
    AddNoise(biped.model, seen, random);
    const ObservationFit fit = EstimateObserved(biped.model, seen, {}).fit;
    EXPECT_TRUE(fit.settled);
    for (std::size_t s = 0; s < sources.size(); ++s) {
      if (sources[s].role != Source::Role::kNoise) continue;
      EXPECT_GT(fit.spread.sd[s], 0.1 * sources[s].sd) << sources[s].name << ", seed " << seed;
    }
  }
}

TEST(ObservationFit, FindsTheComplianceOfTheHips) {
  const ObservedRobot model = MakeTouchingBiped();
  Random random(12);
  const ObservedValues truth = RandomTruth(model, 1, random);
  const Observations seen = SimulateTouches(model, truth, 100, 1, Eigen::Vector3d::Zero(), random);
  const ObservedEstimate estimate = EstimateObserved(model, seen, {});
  const int hip = FindParameter(model.robot.parameters, "left_3.compliance_z");
  // Loads depend on the lengths of the legs, which touches do not determine: 1 mm in 0.5 m. One
  // number has noise, 3 mm as first guessed, and 300 have none.
  EXPECT_NEAR(estimate.fit.values.robot[hip] / truth.robot[hip], 1.0, 1e-2);
}

TEST(ObservationFit, IntervalsCoverTheTruth) {
  const ObservedRobot model = MakeTouchingBiped();
  int inside = 0;
  int all = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Random random(seed);
    const ObservedValues truth = RandomTruth(model, 3, random);
    const Observations touches =
        SimulateTouches(model, truth, 60, 3, Eigen::Vector3d(2e-3, 4e-3, 4e-3), random);
    const ObservationFit fit = EstimateObserved(model, touches, {}).fit;
    EXPECT_TRUE(fit.settled);
    const double factor = StudentQuantile(0.975, fit.degrees_of_freedom);
    for (int i = 0; i < model.robot.parameter_count(); ++i) {
      const Parameter& parameter = model.robot.parameters[i];
      if (parameter.kind != ParameterKind::kTheta) continue;
      const int entry = fit.entry_of_unknown[model.unknown[i]];
      const double sd = std::sqrt(fit.covariance(entry, entry));
      ++all;
      if (std::abs(fit.values.robot[i] - truth.robot[i]) <= factor * sd) ++inside;
    }
  }
  // 192 offsets, which are correlated within each robot. They count as about 70, so that two
  // standard errors are 5 %.
  EXPECT_GT(inside, 0.90 * all) << inside << " of " << all;
  EXPECT_LT(inside, 0.995 * all) << inside << " of " << all;
}

TEST(ObservationFit, IntervalsHoldWhereOffsetsAreTwiceAsLargeAsExpected) {
  // Few touches tell little about the legs, so that their prior stays too narrow. Few numbers
  // determine its width, and the intervals must take this into account.
  const ObservedRobot model = MakeTouchingBiped({"*.compliance_*"});
  int inside = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Random random(100 + seed);
    ObservedValues truth = RandomTruth(model, 1, random);
    for (int i = 0; i < model.robot.parameter_count(); ++i) {
      if (model.robot.parameters[i].kind == ParameterKind::kTheta) truth.robot[i] *= 2.0;
    }
    const Observations touches =
        SimulateTouches(model, truth, 20, 1, Eigen::Vector3d(1e-3, 2e-3, 2e-3), random);
    const ObservationFit fit = EstimateObserved(model, touches, {}).fit;
    const double factor = StudentQuantile(0.975, fit.degrees_of_freedom);
    for (int i = 0; i < model.robot.parameter_count(); ++i) {
      const Parameter& parameter = model.robot.parameters[i];
      if (parameter.kind != ParameterKind::kTheta) continue;
      const int entry = fit.entry_of_unknown[model.unknown[i]];
      const double half = factor * std::sqrt(fit.covariance(entry, entry));
      all += 1;
      inside += std::abs(fit.values.robot[i] - truth.robot[i]) <= half ? 1 : 0;
    }
  }
  EXPECT_GT(inside, 0.90 * all) << inside << " of " << all;
  EXPECT_LT(inside, all) << inside << " of " << all;
}

TEST(ObservationFit, NamesATouchWithoutContact) {
  const ObservedRobot model = MakeTouchingBiped();
  Random random(5);
  const ObservedValues truth = RandomTruth(model, 1, random);
  Observations touches =
      SimulateTouches(model, truth, 40, 1, Eigen::Vector3d(2e-3, 4e-3, 4e-3), random);
  const ObservedEstimate clean = EstimateObserved(model, touches, {});
  EXPECT_TRUE(clean.outliers.empty());
  const int elbow = FindJoint(model.robot.tree, "arm_right_3");
  touches.q(17, model.robot.tree.joints[elbow].coordinate) -= 0.4;  // lifts the hand into the air
  const ObservedEstimate estimate = EstimateObserved(model, touches, {});
  ASSERT_EQ(estimate.outliers.size(), 1u);
  EXPECT_EQ(estimate.outliers[0].observation, 17);
  EXPECT_EQ(estimate.fit.weights[17], 0.0);
}

TEST(ObservationFit, SameTouchesGiveTheSameBitsOnAnyNumberOfThreads) {
  const ObservedRobot model = MakeTouchingBiped();
  Random random(7);
  const ObservedValues truth = RandomTruth(model, 2, random);
  const Observations touches =
      SimulateTouches(model, truth, 24, 2, Eigen::Vector3d(2e-3, 4e-3, 4e-3), random);
  const auto one = CrossValidate(model, touches, {}, 4, 1);
  const auto two = CrossValidate(model, touches, {}, 4, 2);
  EXPECT_EQ(one.left, two.left);
  EXPECT_EQ(EstimateObserved(model, touches, {}).fit.values.robot,
            EstimateObserved(model, touches, {}).fit.values.robot);
}

TEST(ObservationFit, ATableThatWasMovedIsRegisteredAnew) {
  const ObservedRobot model = MakeTouchingBiped();
  Random random(8);
  ObservedValues truth = RandomTruth(model, 1, random);
  const int table[] = {model.instrument(0).quantities[1], model.instrument(1).quantities[1]};
  truth.quantities[table[0]].x += Eigen::Vector3d(0.02, 0.01, -0.005);
  truth.quantities[table[1]].x[0] = -0.05;
  const Observations touches =
      SimulateTouches(model, truth, 16, 1, Eigen::Vector3d::Zero(), random);
  ObservedValues known = truth;
  for (int t : table) known.quantities[t].x.setZero();
  known.effects.clear();
  Spread exact = FirstSpread(model.setup.sources);
  exact[kHeight] = exact[kTilt] = 1e-9;
  EXPECT_LT(Largest(LeftAfterRegistration(model, touches, known, exact)), 1e-9);
  EXPECT_GT(Largest(LeftOf(model, touches, known)), 0.01);
  EXPECT_THROW(LeftAfterRegistration(model, SelectPostures(touches, {0, 1, 2, 3, 5}), known, exact),
               InputError);
}

}  // namespace
}  // namespace elastocal
