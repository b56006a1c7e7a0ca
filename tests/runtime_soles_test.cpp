// SPDX-License-Identifier: Apache-2.0
// What gives way below the markers of the feet, at run time.
#include <algorithm>

#include <gtest/gtest.h>

#include "elastocal/robot/legs.hpp"
#include "elastocal/robot/statics.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/runtime_fixture.hpp"

namespace elastocal {
namespace {

TEST_F(Runtime, ASoleSinksByTheWholeWeight) {
  const Eigen::VectorXd q = Posture(4);
  const double weight = 9.81 * TotalMass(project_.tree);
  Compensator firm = Make();
  for (int leg : {0, 1}) {
    const Leg on = Legs()[static_cast<std::size_t>(leg)];
    stored_.soles = {{.leg = on.chain, .changes = 2, .compliance = 1e-6, .sd = 1e-8}};
    Compensator soft = Make();
    firm.Forward(q, kNoTorque, 1u << leg);
    soft.Forward(q, kNoTorque, 1u << leg);
    const Eigen::Vector3d up = on.R_floor_foot.transpose() * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d sunk = firm.root_pose().translation() - soft.root_pose().translation();
    EXPECT_NEAR(sunk.dot(up), 1e-6 * weight, 1e-8);  // 0.9 mm
    EXPECT_LT((sunk - sunk.dot(up) * up).norm(), 1e-8);
    // The other foot is firm.
    firm.Forward(q, kNoTorque, 2u >> leg);
    soft.Forward(q, kNoTorque, 2u >> leg);
    EXPECT_EQ(firm.root_pose().matrix(), soft.root_pose().matrix());
    // The geometry by itself has no springs, and one that may be none is not applied.
    stored_.soles[0].sd = 1e-6;
    Compensator unknown = Make();
    firm.Forward(q, kNoTorque, 1u << leg);
    unknown.Forward(q, kNoTorque, 1u << leg);
    EXPECT_EQ(firm.root_pose().matrix(), unknown.root_pose().matrix());
  }
  stored_.soles[0] = {.leg = "leg_lefd", .changes = 2, .compliance = 1e-6, .sd = 1e-8};
  ExpectInputError([&] { Make(); }, {"soles", "leg_lefd", "leg_left"});
}

TEST_F(Runtime, OnTwoFeetTheSolesSinkByWhatTheLegsBear) {
  for (auto& [name, value] : stored_.joint_errors) value = 0.0;  // the feet share evenly
  Compensator firm = Make();
  const std::vector<Leg> legs = Legs();
  for (const Leg& leg : legs) {
    stored_.soles.push_back({.leg = leg.chain, .changes = 2, .compliance = 1e-6, .sd = 1e-8});
  }
  Compensator soft = Make();
  firm.Forward(project_.motion.rest, kNoTorque, 3);
  soft.Forward(project_.motion.rest, kNoTorque, 3);
  const double sunk = firm.root_pose().translation().z() - soft.root_pose().translation().z();
  double leg = 0.0;
  for (const Link& link : project_.tree.links) {
    const int joint = link.body - 1;
    if (std::ranges::find(legs[0].joints, joint) != legs[0].joints.end()) leg += link.mass;
  }
  const double all = TotalMass(project_.tree);
  EXPECT_NEAR(sunk, 1e-6 * 9.81 * (0.5 * all - leg) * all / (all - leg), 2e-6);
  // The legs' own weight, of which this has too little, is a fifth of what the soles bear.
  EXPECT_NEAR(sunk / (0.5e-6 * 9.81 * all), 0.8, 0.05);
}

}  // namespace
}  // namespace elastocal
