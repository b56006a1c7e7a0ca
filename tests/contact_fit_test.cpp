#include "elastocal/contact/contact_fit.hpp"

#include <gtest/gtest.h>

#include "elastocal/contact/touch_figures.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/statistics.hpp"
#include "tests/touching_biped.hpp"

namespace elastocal {
namespace {

TEST(ContactFit, PredictsOtherTouchesExactlyAfterTouchesWithoutNoise) {
  const ContactModel model = MakeTouchingBiped({"*.compliance_*"});
  Random random(11);
  const ContactValues truth = RandomTruth(model, {}, 1, random);
  const Touches seen = SimulateTouches(model, truth, 60, 1, Eigen::Vector3d::Zero(), random);
  const Touches others = SimulateTouches(model, truth, 10, 1, Eigen::Vector3d::Zero(), random);
  ContactFit start = StartContacts(model, seen);
  start.spread[ContactSource::kHeight] = start.spread[ContactSource::kTilt] = 1e-9;
  const ContactFit fit =
      FitContacts(model, seen, start, {.estimate_spread = false, .max_updates = 30});
  // 180 numbers determine all that touches see.
  const Eigen::MatrixX3d left = LeftOfTouches(model, others, fit.values);
  EXPECT_LT(left.cwiseAbs().maxCoeff(), 1e-8);
}

TEST(ContactFit, FindsTheComplianceOfTheHips) {
  const ContactModel model = MakeTouchingBiped();
  Random random(12);
  const ContactValues truth = RandomTruth(model, {}, 1, random);
  const Touches seen = SimulateTouches(model, truth, 100, 1, Eigen::Vector3d::Zero(), random);
  const ContactEstimate estimate = EstimateContacts(model, seen, {});
  const int hip = FindParameter(model.robot.parameters, "left_3.compliance_z");
  // Loads depend on the lengths of the legs, which touches do not determine: 1 mm in 0.5 m.
  EXPECT_NEAR(estimate.fit.values.robot[hip] / truth.robot[hip], 1.0, 2e-3);
}

TEST(ContactFit, IntervalsCoverTheTruth) {
  const ContactModel model = MakeTouchingBiped();
  int inside = 0;
  int all = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Random random(seed);
    const ContactValues truth = RandomTruth(model, {}, 3, random);
    const Touches touches =
        SimulateTouches(model, truth, 60, 3, Eigen::Vector3d(2e-3, 4e-3, 4e-3), random);
    const ContactFit fit = EstimateContacts(model, touches, {}).fit;
    EXPECT_TRUE(fit.settled);
    const double factor = StudentQuantile(0.975, fit.degrees_of_freedom);
    for (int i = 0; i < model.robot.parameter_count(); ++i) {
      const Parameter& parameter = model.robot.parameters[i];
      if (parameter.kind != ParameterKind::kTheta) continue;
      const int entry = fit.entry_of_unknown[model.unknown[i]];
      const double sd = std::sqrt(fit.covariance(entry, entry));
      ++all;
      if (std::abs(fit.values.robot[i] - truth.robot[i]) <= factor * sd) ++inside;
    }
  }
  // 192 offsets, of which those of a robot are correlated: as about 70, so two standard errors
  // are 5 %.
  EXPECT_GT(inside, 0.90 * all) << inside << " of " << all;
  EXPECT_LT(inside, 0.995 * all) << inside << " of " << all;
}

TEST(ContactFit, NamesATouchWithoutContact) {
  const ContactModel model = MakeTouchingBiped();
  Random random(5);
  const ContactValues truth = RandomTruth(model, {}, 1, random);
  Touches touches = SimulateTouches(model, truth, 40, 1, Eigen::Vector3d(2e-3, 4e-3, 4e-3), random);
  const ContactEstimate clean = EstimateContacts(model, touches, {});
  EXPECT_TRUE(clean.outliers.empty());
  const int elbow = FindJoint(model.robot.tree, "arm_right_3");
  touches.q(17, model.robot.tree.joints[elbow].coordinate) -= 0.4;  // the hand is in the air
  const ContactEstimate estimate = EstimateContacts(model, touches, {});
  ASSERT_EQ(estimate.outliers.size(), 1u);
  EXPECT_EQ(estimate.outliers[0].touch, 17);
  EXPECT_EQ(estimate.fit.weights[17], 0.0);
}

TEST(ContactFit, SameTouchesGiveTheSameBitsOnAnyNumberOfThreads) {
  const ContactModel model = MakeTouchingBiped();
  Random random(6);
  const ContactValues truth = RandomTruth(model, {}, 2, random);
  const Touches touches =
      SimulateTouches(model, truth, 24, 2, Eigen::Vector3d(2e-3, 4e-3, 4e-3), random);
  const auto one = CrossValidateTouches(model, touches, {}, 4, 1);
  const auto two = CrossValidateTouches(model, touches, {}, 4, 2);
  EXPECT_EQ(one.left, two.left);
  EXPECT_EQ(EstimateContacts(model, touches, {}).fit.values.robot,
            EstimateContacts(model, touches, {}).fit.values.robot);
}

TEST(ContactFit, ATableThatWasMovedIsRegisteredAnew) {
  const ContactModel model = MakeTouchingBiped();
  Random random(8);
  ContactValues truth = RandomTruth(model, {}, 1, random);
  truth.tables[0].height_tilts += Eigen::Vector3d(0.02, 0.01, -0.005);
  truth.tables[1].height_tilts[0] = -0.05;
  const Touches touches = SimulateTouches(model, truth, 16, 1, Eigen::Vector3d::Zero(), random);
  ContactValues known = truth;
  known.tables[0].height_tilts.setZero();
  known.tables[1].height_tilts.setZero();
  known.sessions.clear();
  ContactSpread exact;
  exact[ContactSource::kHeight] = exact[ContactSource::kTilt] = 1e-9;
  const Eigen::MatrixX3d left = LeftAfterRegistration(model, touches, known, exact);
  EXPECT_LT(left.cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_GT(LeftOfTouches(model, touches, known).col(0).cwiseAbs().maxCoeff(), 0.01);
  EXPECT_THROW(LeftAfterRegistration(model, SelectTouches(touches, {0, 1, 2, 3, 5}), known, exact),
               InputError);
}

}  // namespace
}  // namespace elastocal
