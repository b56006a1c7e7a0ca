// SPDX-License-Identifier: Apache-2.0
#include "elastocal/identifiability/regressor.hpp"

#include <gtest/gtest.h>

#include "elastocal/robot/jacobian.hpp"
#include "tests/random_robot.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

using Seen = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;

Eigen::MatrixXd Postures(const RobotTree& tree, int count) {
  Random random(1);
  Eigen::MatrixXd q(count, tree.coordinate_count());
  for (int i = 0; i < count; ++i) q.row(i) = RandomPosture(tree, random);
  return q;
}

/// Psi^T Psi by the whole regressor, in which the rows of unseen markers are zero.
Eigen::MatrixXd DenseProduct(const ErrorModel& model, const Geometry& geometry,
                             const Eigen::MatrixXd& q, const Seen& seen) {
  Eigen::MatrixXd psi(3 * model.marker_count() * q.rows(), model.parameter_count());
  GeneralizedJacobian jacobian(model);
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    jacobian.Evaluate(geometry, q.row(i).transpose());
    Eigen::MatrixXd J = jacobian.Dense();
    for (int m = 0; m < model.marker_count(); ++m) {
      if (seen.size() > 0 && !seen(i, m)) J.middleRows(3 * m, 3).setZero();
    }
    psi.middleRows(i * J.rows(), J.rows()) = J;
  }
  return psi.transpose() * psi;
}

void ExpectFactor(const ErrorModel& model, const Eigen::MatrixXd& q, const Seen& seen) {
  Random random(2);
  const Geometry geometry = ApplyErrors(model, random.NormalVector(model.parameter_count(), 0.01));
  const Eigen::MatrixXd R = RegressorFactor(model, geometry, q, seen);
  const Eigen::MatrixXd expected = DenseProduct(model, geometry, q, seen);
  ASSERT_EQ(R.cols(), model.parameter_count());
  EXPECT_LE(R.rows(), R.cols());
  EXPECT_TRUE(R.isUpperTriangular(0.0));
  // Both products round to some 1e-16 of their norm, at worst times the number of rows.
  EXPECT_LT((R.transpose() * R - expected).norm(), 1e-13 * expected.norm());
}

TEST(RegressorFactor, HasTheProductOfTheRegressor) {
  ExpectFactor(TalosLegModel(), Postures(TalosLeg(), 40), {});
}

TEST(RegressorFactor, LeavesOutUnseenMarkers) {
  const ErrorModel leg = TalosLegModel();
  Random random(5);
  Seen seen(40, leg.marker_count());
  for (bool& one : seen.reshaped()) one = random.Index(3) > 0;
  seen.col(4) = false;  // never seen
  seen.row(7) = false;  // an empty posture
  ExpectFactor(leg, Postures(leg.tree, 40), seen);
}

TEST(RegressorFactor, OfFewPosturesIsShort) {
  const ErrorModel leg = TalosLegModel();
  ExpectFactor(leg, Postures(leg.tree, 1), {});
  const Geometry nominal = ApplyErrors(leg, Eigen::VectorXd::Zero(leg.parameter_count()));
  EXPECT_EQ(RegressorFactor(leg, nominal, Postures(leg.tree, 1), {}).rows(), 27);
  EXPECT_EQ(RegressorFactor(leg, nominal, Postures(leg.tree, 0), {}).rows(), 0);
}

}  // namespace
}  // namespace elastocal
