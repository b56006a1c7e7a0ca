// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/balanced_motion.hpp"

#include <utility>

#include "elastocal/math/numbers.hpp"
#include "elastocal/simulation/motion_recorder.hpp"
#include "elastocal/simulation/stand_through.hpp"
#include "elastocal/simulation/standing_feet.hpp"

namespace elastocal {
namespace {

/// The motion sampled at `rate_hz` and delayed by one sample, because StandThrough looks at the
/// robot from the end of the first sample on.
JointMotion Sampled(const Motion& motion, const std::vector<int>& support, Eigen::Index samples,
                    double rate_hz) {
  JointMotion sampled;
  sampled.q.resize(samples, PostureAt(motion, 0.0).size());
  sampled.time_s.resize(samples);
  sampled.support.assign(Size(samples), support);
  for (Eigen::Index i = 0; i < samples; ++i) {
    sampled.time_s[i] = static_cast<double>(i) / rate_hz;
    sampled.q.row(i) = PostureAt(motion, sampled.time_s[i] - 1.0 / rate_hz).transpose();
  }
  return sampled;
}

}  // namespace

TrueMotion PlayBalanced(const TrueRobot& robot, const RobotTree& described,
                        const std::vector<int>& support, const Motion& motion,
                        const Transform& T_camera_world, const PhysicsOptions& options) {
  std::vector<Sole> soles;
  for (const int foot : support) soles.push_back(SoleOf(foot, options));
  MotionRecorder recorder(robot, motion, T_camera_world);
  // There is one sample to spare, because StandThrough may drop the last one by rounding.
  const JointMotion sampled =
      Sampled(motion, support, recorder.frames() + 2, recorder.motion.rate_hz);
  Stabiliser stabiliser(described, soles);
  StandThroughOptions through;
  through.stabiliser = &stabiliser;
  Eigen::Index frame = 0;
  through.watch = [&](Eigen::Index, const Eigen::VectorXd&, const VirtualRobot& body) {
    if (frame >= recorder.frames()) return;
    if (frame == 0) recorder.Begin(body, support.size());
    recorder.Record(frame++, body);
  };
  const StandingRun run = StandThrough(robot, soles, sampled, options, through);
  if (!run.stood) throw Fallen(run.time_s);
  return std::move(recorder.motion);
}

}  // namespace elastocal
