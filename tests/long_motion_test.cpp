// SPDX-License-Identifier: Apache-2.0
// Fitting waist and markers to motions of many moments.

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "elastocal/calibration/calibrate.hpp"
#include "tests/slow_legs.hpp"

namespace elastocal {
namespace {

/// Makes each motion `times` times longer.
void PlayLonger(int times, SlowLegs& legs) {
  for (PlayedTrial& trial : legs.robot.trials) {
    if (!trial.trial.moments) continue;
    const Eigen::MatrixXd ways = trial.q;
    trial.q.resize(times * ways.rows(), ways.cols());
    for (Eigen::Index i = 0; i < trial.q.rows(); ++i) {
      const double way = static_cast<double>(i % times) / times;
      const Eigen::Index next = std::min(i / times + 1, ways.rows() - 1);
      trial.q.row(i) = (1.0 - way) * ways.row(i / times) + way * ways.row(next);
    }
  }
}

/// Refits waist and markers with the true joints.
CalibrationResult RefitLegs(const SlowLegs& legs, const Recording& recording) {
  std::map<std::string, double> joints;
  for (int i = 0; i < legs.robot.model.parameter_count(); ++i) {
    const Parameter& parameter = legs.robot.model.parameters[i];
    if (!IsExternal(parameter.kind)) joints[parameter.name] = legs.truth[i];
  }
  return RefitExternals(legs.robot.model, recording, legs.robot.base, {}, joints);
}

// Most moments of a long motion add little about waist and markers. A part of the moments gives
// noise and markers. A few updates with all moments name any errors.
TEST(LongMotion, FewUpdatesRefitMarkersToLongMotions) {
  constexpr int kWrong = 200;  // a moment outside of that part
  SlowLegs legs;
  PlayLonger(3, legs);
  Recording recording = RecordWays(legs, 0.1e-3, Eigen::Vector3d::Zero(), 1);
  ASSERT_EQ(recording.posture_count(), 900);
  int wrong = 0;
  while (!Seen(recording, kWrong, wrong)) ++wrong;
  recording.markers(kWrong, 3 * wrong) += 20e-3;
  const CalibrationResult refit = RefitLegs(legs, recording);
  EXPECT_EQ(refit.termination, Termination::kConverged);
  EXPECT_LT(refit.iterations, 120) << "80 of the part; 175 with all where they tell the noise";
  const auto named = [&](const Outlier& one) {
    return one.posture == kWrong && one.marker == wrong;
  };
  EXPECT_TRUE(std::ranges::any_of(refit.outliers, named));
  double off = 0.0, expected = 0.0;
  for (int i = 0; i < refit.model.parameter_count(); ++i) {
    if (refit.model.parameters[i].kind != ParameterKind::kMarker || !(refit.sd[i] > 0.0)) continue;
    if (refit.status[i] != ParameterStatus::kEstimated) continue;
    off += std::pow((refit.delta[i] - legs.truth[i]) / refit.sd[i], 2);
    ++expected;
  }
  EXPECT_GT(expected, 50.0);
  EXPECT_LT(std::sqrt(off / expected), 2.0) << "in standard deviations";
}

// During the motion of one leg, two of 15 markers are displaced. Least squares would take this for
// noise.
TEST(LongMotion, MarkersWrongThroughoutAMotionAreNoNoise) {
  SlowLegs legs;
  PlayLonger(2, legs);
  legs.robot.trials.push_back(legs.robot.trials.back());
  legs.robot.trials.back().trial.name += "_again";
  Recording recording = RecordWays(legs, 0.1e-3, Eigen::Vector3d::Zero(), 1);
  const auto find = [&](const char* name) {
    const auto& names = recording.marker_names;
    return static_cast<int>(std::ranges::find(names, name) - names.begin());
  };
  const int foot = find("LFOOT_1"), waist = find("WAIST_1");
  ASSERT_LT(std::max(foot, waist), recording.marker_count());
  int wrong = 0;
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (recording.trial[i] != 0) continue;
    recording.markers(i, 3 * foot) += 0.1;
    recording.markers(i, 3 * waist + 1) += 0.1;
    wrong += 2;
  }
  int named = 0;
  for (const Outlier& one : RefitLegs(legs, recording).outliers) {
    const bool moved = one.marker == foot || one.marker == waist;
    named += recording.trial[one.posture] == 0 && moved ? 1 : 0;
  }
  EXPECT_EQ(named, wrong);
}

}  // namespace
}  // namespace elastocal
