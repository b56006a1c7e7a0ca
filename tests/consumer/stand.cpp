// SPDX-License-Identifier: Apache-2.0
// A controller with elastocal at run time: reads the model that `elastocal export --format runtime`
// wrote, and prints the commands that put the robot where the nominal one stands at zero.
#include <exception>
#include <iostream>

#include <elastocal/runtime/compensator.hpp>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    elastocal::Compensator robot(elastocal::ReadRuntimeModel(std::filesystem::path(argv[1])));
    const Eigen::VectorXd q = Eigen::VectorXd::Zero(robot.model().coordinate_count());
    const elastocal::CompensatorStatus status = robot.Command(q, Eigen::VectorXd(), 0);
    std::cout << robot.command().transpose() << "\n" << elastocal::DescribeStatus(status) << "\n";
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 3;
  }
  return 0;
}
