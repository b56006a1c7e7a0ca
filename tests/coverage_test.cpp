// SPDX-License-Identifier: Apache-2.0
// Checks that the 95 % intervals of a whole-body calibration contain the truth that often.

#include <array>
#include <cmath>
#include <cstdio>
#include <thread>

#include <gtest/gtest.h>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/calibration/frame_precision.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "tests/standing_humanoid.hpp"

namespace elastocal {
namespace {

/// Numbers of intervals, and of those that contain the truth.
struct Coverage {
  int intervals = 0, hits = 0;

  void Count(double error, double half_width) {
    ++intervals;
    hits += std::abs(error) <= half_width ? 1 : 0;
  }
  void operator+=(const Coverage& other) {
    intervals += other.intervals;
    hits += other.hits;
  }
  double percent() const { return 100.0 * hits / intervals; }
};

/// A truth drawn from the prior. Errors of joints already are. A compliance is never negative, so
/// it is the absolute value of a draw.
Eigen::VectorXd DrawFromPrior(const StandingHumanoid& robot, std::uint64_t seed) {
  const Prior prior;
  Eigen::VectorXd truth = robot.DrawTruth(seed);
  Random random(seed + 1000);
  for (int i = 0; i < robot.model.parameter_count(); ++i) {
    const Parameter& parameter = robot.model.parameters[i];
    if (!IsCompliance(parameter.kind)) continue;
    truth[i] = std::abs(random.Normal(prior.Of(robot.model.tree, parameter)));
  }
  return truth;
}

/// Both legs and one arm, which take a minute. Each leg moves while the other one stands.
StandingHumanoid LegsAndArm(int postures) {
  StandingHumanoid robot(postures);
  std::erase_if(robot.trials, [](const PlayedTrial& played) {
    return played.trial.name == "head_trunk" || played.trial.name == "torso_arm_right";
  });
  const Recording seen = robot.Record(Eigen::VectorXd::Zero(robot.model.parameter_count()), {});
  const ObservationMask mask = SeenMask(seen);
  std::vector<std::string> names;
  for (int m = 0; m < mask.cols(); ++m) {
    if (mask.col(m).any()) names.push_back(seen.marker_names[m]);
  }
  robot.model = SelectMarkers(robot.model, names);
  robot.base = FindBaseParameters(robot.model, robot.project.identifiability);
  return robot;
}

/// Sums of the squared errors of the ends of limbs, and of the expected ones.
struct Frames {
  double position = 0.0, expected_position = 0.0, attitude = 0.0, expected_attitude = 0.0;

  void operator+=(const Frames& other) {
    position += other.position;
    expected_position += other.expected_position;
    attitude += other.attitude;
    expected_attitude += other.expected_attitude;
  }
};

std::vector<int> EndsOfLimbs(const StandingHumanoid& robot) {
  std::vector<int> ends;
  for (const SupportLeg& leg : robot.model.legs) ends.push_back(leg.link);
  for (const char* arm : {"torso_arm_left", "torso_arm_right"}) {
    const int chain = FindChain(robot.project, arm);
    ends.push_back(robot.project.chains[static_cast<std::size_t>(chain)].tip_link);
  }
  return ends;
}

Frames CompareFrames(const StandingHumanoid& robot, const Eigen::VectorXd& truth,
                     const CalibrationResult& result, const Recording& recording) {
  const std::vector<int> links = EndsOfLimbs(robot);
  const auto from_root = [&](const Eigen::VectorXd& delta, int posture, int link) {
    const Geometry geometry = ApplyErrors(robot.model, delta);
    return Transform(WaistPose(geometry).inverse() *
                     CalibratedLinkTransforms(robot.model, geometry,
                                              recording.q.row(posture).transpose())[link]);
  };
  Frames frames;
  const std::vector<FramePrecision> assessed = AssessFrames(result, recording, links);
  EXPECT_EQ(assessed.size(), links.size() - 1);  // the right arm was not recorded
  for (const FramePrecision& frame : assessed) {
    constexpr int kEvery = 7;
    int count = 0;
    double position = 0.0, attitude = 0.0;
    for (int i = 0; i < recording.posture_count(); i += kEvery, ++count) {
      const Transform there = from_root(truth, i, frame.link);
      const Transform here = from_root(result.delta, i, frame.link);
      position += (there.translation() - here.translation()).squaredNorm();
      attitude +=
          std::pow(Eigen::AngleAxisd(there.linear().transpose() * here.linear()).angle(), 2);
    }
    frames += {position / count, std::pow(frame.position_sd, 2), attitude / count,
               std::pow(frame.attitude_sd, 2)};
  }
  return frames;
}

/// Coverage of the intervals for a robot's joints and legs, by kind of parameter.
struct Coverages {
  Coverage geometry, torsion, legs;
  Coverage unsupported;  ///< for parameters with the status unsupported
  Frames frames;
  int unsettled = 0;

  void operator+=(const Coverages& other) {
    geometry += other.geometry;
    torsion += other.torsion;
    legs += other.legs;
    unsupported += other.unsupported;
    frames += other.frames;
    unsettled += other.unsettled;
  }
};

Coverages CalibrateOnce(const StandingHumanoid& robot, std::uint64_t seed) {
  const Eigen::VectorXd truth = DrawFromPrior(robot, seed);
  const Recording recording =
      robot.Record(truth, {.torque_sensors = robot.project.torque_sensors, .seed = seed});
  const CalibrationResult result =
      Calibrate(robot.model, recording, robot.base, ModelKind::kFull, {});
  Coverages found;
  found.frames = CompareFrames(robot, truth, result, recording);
  found.unsettled = result.termination == Termination::kConverged && result.settled ? 0 : 1;
  for (int i = 0; i < robot.model.parameter_count(); ++i) {
    const ParameterKind kind = robot.model.parameters[i].kind;
    if (IsExternal(kind)) continue;
    Coverage& counted = result.status[i] != ParameterStatus::kEstimated ? found.unsupported
                        : kind == ParameterKind::kTorsion               ? found.torsion
                        : IsCompliance(kind)                            ? found.legs
                                                                        : found.geometry;
    counted.Count(result.delta[i] - truth[i], result.interval_factor * result.sd[i]);
  }
  return found;
}

void Print(const char* what, const Coverage& coverage) {
  std::printf("95 %% intervals of %s: %.1f %% of %d hold the truth\n", what, coverage.percent(),
              coverage.intervals);
}

// Intervals of one calibration are correlated. The share over 50 truths scatters by less than one
// per cent. Compliances end at zero, where half of an interval is empty, so that they cover a
// little more.
TEST(Coverage, NinetyFivePercentIntervalsHoldTheTruth) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP()
      << "a statistic of fifty fits, twenty times slower under the sanitizers, which watch "
         "the same code in the other tests";
#endif
  constexpr int kSeeds = 50;
  const StandingHumanoid robot = LegsAndArm(16);
  std::array<Coverages, 2> halves;
  std::vector<std::thread> threads;
  for (std::size_t half = 0; half < halves.size(); ++half) {
    threads.emplace_back([&, half] {
      for (std::size_t seed = 1 + half; seed <= kSeeds; seed += halves.size()) {
        halves[half] += CalibrateOnce(robot, seed);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  Coverages found = halves[0];
  found += halves[1];
  Coverage all = found.geometry;
  all += found.torsion;
  all += found.legs;
  Print("all estimated parameters", all);
  Print("the joints' geometry", found.geometry);
  Print("the joints' compliances", found.torsion);
  Print("the legs' compliances", found.legs);
  Print("parameters held for want of support", found.unsupported);
  const Frames& frames = found.frames;
  const double position = std::sqrt(frames.position / frames.expected_position);
  const double attitude = std::sqrt(frames.attitude / frames.expected_attitude);
  std::printf("errors of the ends of limbs over those to be expected: %.2f in place, %.2f turned\n",
              position, attitude);
  EXPECT_NEAR(position, 1.0, 0.15);
  EXPECT_NEAR(attitude, 1.0, 0.15);
  EXPECT_EQ(found.unsettled, 0);
  for (const Coverage& coverage : {all, found.geometry, found.torsion, found.legs}) {
    EXPECT_GT(coverage.intervals, 4 * kSeeds);
    EXPECT_GT(coverage.percent(), 92.0);
    EXPECT_LT(coverage.percent(), 98.5);
  }
  EXPECT_LT(all.percent(), 98.0);
}

}  // namespace
}  // namespace elastocal
