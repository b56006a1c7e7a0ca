// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/true_motion.hpp"

#include <string>
#include <utility>

#include "elastocal/math/input_error.hpp"
#include "elastocal/simulation/motion_recorder.hpp"
#include "elastocal/simulation/standing_feet.hpp"

namespace elastocal {
TrueMotion PlayMotion(const TrueRobot& robot, const std::vector<int>& support, const Motion& motion,
                      const Transform& T_camera_world, const PhysicsOptions& options) {
  constexpr double kLongestCreep = 4.0;  // s; friction may go on creeping
  MotionRecorder recorder(robot, motion, T_camera_world);
  VirtualRobot body(robot, support, PostureAt(motion, 0.0), options);
  body.Settle(kLongestCreep);
  const double height = body.Height();
  recorder.Begin(body, support.size());
  int steps = 0;
  for (Eigen::Index i = 0; i < recorder.frames(); ++i) {
    const double time_s = static_cast<double>(i) / recorder.motion.rate_hz;
    for (; steps * body.time_step_s() < time_s - 1e-9; ++steps) {
      body.Command(PostureAt(motion, (steps + 1) * body.time_step_s()));
      body.Step();
    }
    recorder.Record(i, body);
    if (StandsFreely(support, options) && body.FallenFrom(height)) throw Fallen(time_s);
    if (body.Unstable()) {
      throw InputError("the simulation became unstable after " + std::to_string(time_s) +
                       " s: are inertias too small for the robot's motors and springs?");
    }
  }
  return std::move(recorder.motion);
}

}  // namespace elastocal
