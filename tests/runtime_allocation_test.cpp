// SPDX-License-Identifier: Apache-2.0
// The compensator never allocates. The test counts calls of malloc, which operator new uses as
// well.
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/runtime/compensator.hpp"
#include "tests/runtime_calibration.hpp"
#include "tests/test_files.hpp"

namespace {

long allocations = 0;
bool counting = false;

}  // namespace

// The sanitizers replace malloc themselves.
#if defined(__GLIBC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define ELASTOCAL_COUNTS_ALLOCATIONS
extern "C" void* __libc_malloc(std::size_t size);  // NOLINT
extern "C" void* malloc(std::size_t size) {        // NOLINT
  if (counting) ++allocations;
  return __libc_malloc(size);
}
#endif

namespace elastocal {
namespace {

TEST(RuntimeAllocation, NoCallAllocates) {
#ifndef ELASTOCAL_COUNTS_ALLOCATIONS
  GTEST_SKIP() << "malloc cannot be replaced here";
#endif
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  Compensator robot(MakeRuntimeModel(project, RandomCalibration(project, 1)));
  const Eigen::VectorXd q = project.motion.rest, none;
  const Eigen::VectorXd torque =
      Eigen::VectorXd::Ones(static_cast<Eigen::Index>(project.tree.joints.size()));
  std::vector<Eigen::Isometry3d> targets(robot.model().tips.size(), Eigen::Isometry3d::Identity());
  allocations = 0;
  counting = true;
  robot.LimitChanges(q);
  robot.EaseChanges(10.0);
  robot.StartFrom(q);
  for (StandingFeet feet : {0U, 1U, 2U, 3U, 7U}) {
    robot.Forward(q, none, feet);
    robot.Correct(q, torque, feet);
    robot.Command(q, none, feet);
    robot.Command(project.motion.lower, none, feet);  // needs a longer search
    robot.Command(targets.data(), q, torque, feet);
    robot.StartFrom(project.motion.lower);
    robot.Command(q, none, feet);
    robot.Forget();
  }
  counting = false;
  EXPECT_EQ(allocations, 0);
  counting = true;
  const std::vector<double> taken(3, 1.0);  // shows that the hook works
  counting = false;
  EXPECT_GT(allocations, 0);
  EXPECT_EQ(taken.size(), 3U);
}

}  // namespace
}  // namespace elastocal
