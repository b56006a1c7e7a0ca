// Whether the stated 95 % intervals of a calibration of the whole body hold the truth that often.

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/math/random.hpp"
#include "tests/standing_robot.hpp"

namespace elastocal {
namespace {

/// How many intervals there were, and how many hold the truth.
struct Coverage {
  int intervals = 0, hits = 0;

  void Count(double error, double half_width) {
    ++intervals;
    hits += std::abs(error) <= half_width ? 1 : 0;
  }
  double percent() const { return 100.0 * hits / intervals; }
};

/// A truth as the prior expects it: joints' errors are drawn from it anyway; of a compliance, never
/// below zero, the absolute value of a draw.
Eigen::VectorXd DrawFromPrior(const StandingRobot& robot, std::uint64_t seed) {
  const Prior prior;
  Eigen::VectorXd truth = robot.DrawTruth(seed);
  Random random(seed + 1000);
  for (int i : robot.base.kept) {
    const ParameterKind kind = robot.model.parameters[i].kind;
    if (IsCompliance(kind)) truth[i] = std::abs(random.Normal(prior[kind]));
  }
  return truth;
}

/// Both legs and one arm, to be done in a minute: each leg while the other one carries.
StandingRobot LegsAndArm(int postures) {
  StandingRobot robot(postures);
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

TEST(Coverage, NinetyFivePercentIntervalsHoldTheTruth) {
  const int kPostures = getenv("POSTURES") ? atoi(getenv("POSTURES")) : 16;
  const int kSeeds = getenv("SEEDS") ? atoi(getenv("SEEDS")) : 50;
  const StandingRobot robot = LegsAndArm(kPostures);
  Coverage geometry, torsion, legs, unsupported;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const Eigen::VectorXd truth = DrawFromPrior(robot, seed);
    const Recording recording = robot.Record(
        truth, {.torque_sensors = robot.project.torque_sensors, .seed = std::uint64_t(seed)});
    const CalibrationResult result =
        Calibrate(robot.model, recording, robot.base, ModelKind::kFull, {});
    EXPECT_EQ(result.termination, Termination::kConverged) << seed << " " << result.message;
    for (int i : robot.base.kept) {
      const ParameterKind kind = robot.model.parameters[i].kind;
      if (IsExternal(kind)) continue;
      Coverage& counted = result.status[i] != ParameterStatus::kEstimated ? unsupported
                          : kind == ParameterKind::kTorsion               ? torsion
                          : IsCompliance(kind)                            ? legs
                                                                          : geometry;
      counted.Count(result.delta[i] - truth[i], result.interval_factor * result.sd[i]);
    }
    if (getenv("VERBOSE")) {
      std::printf("seed %d: %.2f s, %d iterations, sd %g, scale %g %g, outliers %zu, settled %d\n",
                  seed, result.solve_seconds, result.iterations, result.marker_sd,
                  result.prior_scale.angles, result.prior_scale.lengths, result.outliers.size(),
                  result.settled);
      std::fflush(stdout);
    }
  }
  const Coverage all = {geometry.intervals + torsion.intervals + legs.intervals,
                        geometry.hits + torsion.hits + legs.hits};
  std::printf(
      "95 %% intervals that hold the truth: %.1f %% of %d; joints' geometry %.1f %% of %d, "
      "torsion %.1f %% of %d, legs' compliance %.1f %% of %d; held for want of support %.1f %% of "
      "%d\n",
      all.percent(), all.intervals, geometry.percent(), geometry.intervals, torsion.percent(),
      torsion.intervals, legs.percent(), legs.intervals, unsupported.percent(),
      unsupported.intervals);
  EXPECT_GT(all.percent(), 92.0);
  EXPECT_LT(all.percent(), 98.0);
}

}  // namespace
}  // namespace elastocal
