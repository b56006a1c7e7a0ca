// SPDX-License-Identifier: Apache-2.0
// Numbers that the file of a robot at run time must not hold.
#include <cmath>
#include <functional>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "elastocal/runtime/compensator.hpp"
#include "tests/elastic_arm.hpp"

namespace elastocal {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// What reading says of an arm that was changed so; empty if it is taken.
std::string SaidOf(const std::function<void(RuntimeModel&)>& change) {
  RuntimeModel model = ElasticArm();
  change(model);
  std::stringstream file;
  WriteRuntimeModel(model, file);
  try {
    ReadRuntimeModel(file, "arm.txt");
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(RuntimeFileNumbers, MustBeFinite) {
  const auto of = [](const std::string& entry, const std::string& found) {
    return "arm.txt: entry '" + entry + "': found '" + found +
           "'; a number that is finite was expected";
  };
  EXPECT_EQ(SaidOf([](RuntimeModel& arm) { arm.calibrated[1].twisted.p[0] = kUnbounded; }),
            of("calibrated", "inf"));
  EXPECT_EQ(SaidOf([](RuntimeModel& arm) { arm.nominal[5].body.R[4] = -kUnbounded; }),
            of("nominal", "-inf"));
  EXPECT_EQ(SaidOf([](RuntimeModel& arm) { arm.calibrated[1].compliance[2] = kUnbounded; }),
            of("calibrated", "inf"));
  EXPECT_EQ(SaidOf([](RuntimeModel& arm) { arm.tips[0].frame.pose.p[2] = kUnbounded; }),
            of("tip", "inf"));
  EXPECT_EQ(SaidOf([](RuntimeModel& arm) { arm.mass[3] = kUnbounded; }), of("mass", "inf"));
  EXPECT_EQ(SaidOf([](RuntimeModel& arm) { arm.gravity[1] = kUnbounded; }), of("gravity", "inf"));
}

TEST(RuntimeFileNumbers, LimitsMayBeInfiniteButNotExchanged) {
  EXPECT_EQ(SaidOf([](RuntimeModel& arm) {
              arm.lower[5] = -kUnbounded;
              arm.upper[5] = kUnbounded;
              arm.lower[4] = arm.upper[4];
            }),
            "");
  EXPECT_EQ(SaidOf([](RuntimeModel& arm) { arm.lower[2] = 3.5; }),
            "arm.txt: entry 'upper': found 3 for 'joint2'; at least 3.5, which is its entry of "
            "'lower', was expected");
  EXPECT_EQ(SaidOf([](RuntimeModel& arm) { arm.lower[2] = arm.upper[2] = kUnbounded; }),
            "arm.txt: entry 'upper': found 'joint2' from inf to inf; a range of positions was "
            "expected");
  EXPECT_NE(SaidOf([](RuntimeModel& arm) { arm.lower[2] = std::nan(""); }), "");
}

}  // namespace
}  // namespace elastocal
