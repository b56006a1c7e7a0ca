// SPDX-License-Identifier: Apache-2.0
// Writes a C99 header of a robot with errors, postures, and the library's results for them:
//   write_header FOLDER
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/runtime/c_header.hpp"
#include "tests/runtime_calibration.hpp"
#include "tests/test_files.hpp"

int main(int argc, char** argv) {
  using namespace elastocal;
  if (argc != 2) return 2;
  const std::filesystem::path folder = argv[1];
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  StoredCalibration calibration = RandomCalibration(project, 3);
  calibration.joint_errors["arm_left_4_joint.hysteresis"] = -2e-3;
  calibration.joint_errors["torso_2_joint.backlash"] = 1e-3;
  RuntimeModel model = MakeRuntimeModel(project, calibration);
  // C cannot distinguish the first two names, and the header needs the third itself.
  model.coordinate_names[1] = "a-b";
  model.coordinate_names[2] = "A_b";
  model.link_names[0] = "count";
  std::ofstream(folder / "robot.h")
      << MakeCHeader(model, {.prefix = "robot", .heading = "for the test */ of comments"});
  std::ofstream postures(folder / "postures.txt"), expected(folder / "expected.txt");
  Compensator robot(model);
  Random random(1);
  const auto print = [&](double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%a\n", value);
    expected << text;
  };
  Eigen::VectorXd q, most = project.motion.rest;
  for (Eigen::Index c = 0; c < most.size(); ++c) most[c] = c % 2 != 0 ? 0.005 : -1.0;
  robot.LimitChanges(most);
  robot.EaseChanges(4.0);
  Eigen::VectorXd start = most;
  for (Eigen::Index c = 0; c < start.size(); ++c) start[c] = 0.01 * static_cast<double>(c);
  if (!robot.StartFrom(start)) return 1;
  for (int i = 0; i < 60; ++i) {
    const bool goes_on = i >= 40;  // near the last posture, as in a motion
    if (!goes_on) q = project.motion.rest;
    for (double& position : q) position += (goes_on ? 0.1 : 1.0) * random.Uniform(-0.15, 0.15);
    // Stretched limbs and joints near their limits need a longer search in Command.
    for (Eigen::Index c = 0; i >= 20 && !goes_on && c < q.size(); ++c) {
      const auto at = static_cast<std::size_t>(c);
      q[c] = std::clamp(q[c] - 0.5, model.lower[at], model.upper[at]);
    }
    const auto feet = static_cast<StandingFeet>(goes_on ? i / 10 % 4 : i % 4);
    postures << feet;
    for (double position : q) {
      char text[40];
      std::snprintf(text, sizeof text, " %a", position);
      postures << text;
    }
    postures << "\n";
    robot.Forward(q, Eigen::VectorXd(), feet);
    for (int row = 0; row < 3; ++row) print(robot.link_pose(5).translation()[row]);
    for (int row = 0; row < 3; ++row) print(robot.root_pose().translation()[row]);
    robot.Correct(q, Eigen::VectorXd(), feet);
    for (double value : robot.rigid_positions()) print(value);
    for (double value : robot.root_displacement()) print(value);
    robot.Command(q, Eigen::VectorXd(), feet);
    for (double value : robot.command()) print(value);
    print(robot.residual_m());
  }
  return 0;
}
