// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/support_tie.hpp"

#include <functional>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/math/rotation_vector.hpp"

namespace elastocal {
namespace {

Transform Displaced(const Vector6d& by) {
  Transform T = Transform::Identity();
  T.linear() = RotationFromVector(by.tail<3>());
  T.translation() = by.head<3>();
  return T;
}

/// Exact motion of a body under the screw [a; m], about the origin, for one unit of time.
Transform Screw(const Vector6d& screw) {
  Transform T = Transform::Identity();
  T.linear() = RotationFromVector(screw.head<3>());
  T.translation() = LeftJacobian(screw.head<3>()) * screw.tail<3>();
  return T;
}

/// A robot on one leg: it leans by a degree and is displaced by 5 mm.
SupportTie LeaningRobot() {
  Random random(7);
  SupportTie tie;
  tie.T_ref_waist = Displaced(random.NormalVector(6, 1.0));
  tie.T_ref_foot = tie.T_ref_waist * Displaced(random.NormalVector(6, 0.5));
  tie.T_ref_foot_predicted = tie.T_ref_foot * Displaced(random.NormalVector(6, 0.01));
  tie.deflection = random.NormalVector(6, 0.01);
  return tie;
}

TEST(SupportTie, IsZeroWhereTheLoadedLegReachesFromFootToWaist) {
  SupportTie tie = LeaningRobot();
  // The axes of the foot are those of the reference. The waist is 0.9 m above the foot, then 3 mm
  // lower and leaning.
  tie.T_ref_foot = Displaced((Vector6d() << 1.0, 2.0, 0.0, 0.0, 0.0, 0.0).finished());
  tie.deflection << 0.0, 0.001, -0.003, 0.004, 0.0, 0.0;
  Transform T_foot_waist = Displaced((Vector6d() << 0.1, 0.0, 0.9, 0.2, 0.3, 0.1).finished());
  const Transform T_waist_foot = T_foot_waist.inverse();
  T_foot_waist.translation() += tie.deflection.head<3>();
  T_foot_waist.linear() = RotationFromVector(tie.deflection.tail<3>()) * T_foot_waist.linear();
  tie.T_ref_waist = tie.T_ref_foot * T_foot_waist;
  tie.T_ref_foot_predicted = tie.T_ref_waist * T_waist_foot;
  EXPECT_LT(EvaluateTie(tie).residual.norm(), 1e-15);

  // The waist is half a millimetre lower than the leg explains.
  tie.T_ref_waist.translation().z() -= 0.0005;
  tie.T_ref_foot_predicted.translation().z() -= 0.0005;
  const Vector6d residual = EvaluateTie(tie).residual;
  EXPECT_NEAR(residual[2], -0.0005, 1e-15);
  EXPECT_LT((residual - residual[2] * Vector6d::Unit(2)).norm(), 1e-14);
}

TEST(SupportTie, DerivativesEqualDifferences) {
  const SupportTie tie = LeaningRobot();
  const TieResidual at = EvaluateTie(tie);
  using Change = std::function<void(SupportTie&, const Vector6d&)>;
  const std::vector<std::pair<Matrix6d, Change>> cases = {
      {at.by_waist,
       [](SupportTie& t, const Vector6d& step) {
         t.T_ref_waist = Screw(step) * t.T_ref_waist;
         t.T_ref_foot_predicted = Screw(step) * t.T_ref_foot_predicted;
       }},
      {at.by_leg,
       [](SupportTie& t, const Vector6d& step) {
         t.T_ref_foot_predicted = Screw(step) * t.T_ref_foot_predicted;
       }},
      {at.by_foot,
       [](SupportTie& t, const Vector6d& step) { t.T_ref_foot = t.T_ref_foot * Displaced(step); }},
      {at.by_deflection, [](SupportTie& t, const Vector6d& step) { t.deflection += step; }}};
  constexpr double kStep = 1e-5;  // truncation 1e-10, rounding 1e-11
  for (std::size_t c = 0; c < cases.size(); ++c) {
    for (int i = 0; i < 6; ++i) {
      SupportTie plus = tie;
      SupportTie minus = tie;
      cases[c].second(plus, kStep * Vector6d::Unit(i));
      cases[c].second(minus, -kStep * Vector6d::Unit(i));
      const Vector6d difference =
          (EvaluateTie(plus).residual - EvaluateTie(minus).residual) / (2.0 * kStep);
      EXPECT_LT((difference - cases[c].first.col(i)).norm(), 1e-8) << c << ", " << i;
    }
  }
}

}  // namespace
}  // namespace elastocal
