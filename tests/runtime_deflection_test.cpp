// SPDX-License-Identifier: Apache-2.0
// Deflections of the run-time library that are cut, and those of joints that share a coordinate.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "elastocal/runtime/compensator.hpp"
#include "tests/elastic_arm.hpp"

namespace elastocal {
namespace {

using Angles = Eigen::Matrix<double, 6, 1>;

const Angles kPosture = (Angles() << 0.2, 0.5, -0.6, 0.4, 0.5, 0.1).finished();

/// Angle by which the torque turns the first joint of an arm whose other joints are rigid, about
/// the axis of that joint.
double TurnOfFirst(const RuntimeModel& model, double torque, unsigned* status = nullptr) {
  Compensator robot(model), unloaded(model);
  Angles torques = Angles::Zero();
  unloaded.Forward(kPosture, torques, 0);
  torques[0] = torque;
  const unsigned said = robot.Forward(kPosture, torques, 0);
  if (status != nullptr) *status = said;
  const Eigen::AngleAxisd turn(robot.link_pose(0).linear() *
                               unloaded.link_pose(0).linear().transpose());
  return turn.angle() * turn.axis().z();
}

// The load that a torque balances is its opposite. A spring of 1e-4 rad/(N.m) and a stiffening of
// 1 mrad at 50 N.m, which grows with the square, are together cut to 50 mrad.
TEST(RuntimeDeflection, SpringAndStiffeningAreCutTogether) {
  RuntimeModel model = ElasticArm(0.0);
  model.calibrated[0].compliance[2] = 1e-4;
  model.shifts.push_back({0, EC_STIFFENING, 0, 1e-3, 0.0, 50.0});
  const auto sum = [](double load) { return 1e-4 * load + 1e-3 * load * std::abs(load) / 2500.0; };
  const double limit = CompensatorOptions().largest_turn_rad;
  for (const double load : {20.0, -150.0, 250.0, 400.0, -600.0, 5000.0, -1e5}) {
    unsigned status = 0;
    const double turn = TurnOfFirst(model, -load, &status);
    const bool cut = std::abs(sum(load)) > limit;
    EXPECT_NEAR(turn, cut ? std::copysign(limit, load) : sum(load), 1e-9) << load;
    EXPECT_EQ(status, cut ? unsigned{EC_DEFLECTION_CUT} : 0U) << load;
  }
  // One that works against the spring is cut at the other side.
  model.shifts[0].amount = -1e-3;
  EXPECT_NEAR(TurnOfFirst(model, -1e4), -limit, 1e-9);
  EXPECT_NEAR(TurnOfFirst(model, -200.0), 1e-4 * 200.0 - 1e-3 * 16.0, 1e-9);
  // The command corrects what is left after the cut.
  Compensator robot(model);
  Angles torques = Angles::Zero();
  torques[0] = -1e4;
  EXPECT_EQ(robot.Command(kPosture, torques, 0) & EC_DEFLECTION_CUT, unsigned{EC_DEFLECTION_CUT});
  EXPECT_LT((robot.command() - kPosture).cwiseAbs().maxCoeff(), limit + 0.02);
}

// Two fingers behind the hand, which no end of a limb tells. The second follows the first.
class Fingers {
 public:
  explicit Fingers(double multiplier, bool slides = false) : model_(ElasticArm(1e-5)) {
    for (int i = 0; i < 2; ++i) {
      ec_joint joint{};
      joint.parent = joint.coordinate = 6;
      joint.multiplier = i == 0 ? 1.0 : multiplier;
      joint.prismatic = i == 1 && slides ? 1 : 0;
      joint.twisted = TurnedAboutX(0.0, 0.1, 0.05 * i);
      ec_identity(&joint.body);
      model_.nominal.push_back(joint);
      model_.calibrated.push_back(joint);
      model_.joint_names.push_back("finger" + std::to_string(i));
      model_.mass.push_back(0.0);
      model_.moment.insert(model_.moment.end(), {0.0, 0.0, 0.0});
      model_.leg_of_body.push_back(-1);
    }
    model_.coordinate_names.emplace_back("fingers");
    model_.lower.push_back(-1.0);
    model_.upper.push_back(1.0);
  }

  /// Change of the common position where the fingers deflect by these angles.
  double Change(double first, double second) {
    model_.calibrated[6].compliance[2] = 1e-3 * first;
    model_.calibrated[7].compliance[2] = 1e-3 * second;
    Compensator robot(model_);
    Eigen::VectorXd q(7), torque = Eigen::VectorXd::Zero(8);
    q << kPosture, 0.3;
    torque.tail(2).setConstant(-1e3);
    EXPECT_EQ(robot.Correct(q, torque, 0), 0U);
    return robot.rigid_positions()[6] - q[6];
  }

 private:
  RuntimeModel model_;
};

// The best rigid fingers are those nearest to the deflected ones by least squares.
TEST(RuntimeDeflection, JointsThatShareACoordinateAreCountedOnce) {
  EXPECT_NEAR(Fingers(1.0).Change(4e-3, 4e-3), 4e-3, 1e-12);  // both give way alike
  EXPECT_NEAR(Fingers(1.0).Change(4e-3, 0.0), 2e-3, 1e-12);   // one does: half for both
  EXPECT_NEAR(Fingers(-1.0).Change(4e-3, -4e-3), 4e-3, 1e-12);
  EXPECT_NEAR(Fingers(-1.0).Change(4e-3, 4e-3), 0.0, 1e-12);  // both to one side: no closing
  EXPECT_NEAR(Fingers(0.5).Change(4e-3, 2e-3), 4e-3, 1e-12);
  EXPECT_NEAR(Fingers(0.5).Change(0.0, 2e-3), 0.8e-3, 1e-12);  // 0.5 * 2 / (1 + 0.25)
  // 0.3 m of a slide are as much as a radian: 1 and 0.1 / 0.3 instead of 1 and 0.1.
  EXPECT_NEAR(Fingers(0.1, true).Change(4e-3, 0.0), 4e-3 / (1.0 + 1.0 / 9.0), 1e-12);
}

}  // namespace
}  // namespace elastocal
