// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/residuals.hpp"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/math/random.hpp"
#include "tests/dense_problem.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

/// A leg's recording with gaps; the measured positions need not make sense.
Recording RecordingWithGaps(const ErrorModel& model) {
  Random random(5);
  Recording recording;
  for (const Marker& marker : model.markers) recording.marker_names.push_back(marker.name);
  recording.q.resize(4, model.tree.coordinate_count());
  for (int i = 0; i < 4; ++i) recording.q.row(i) = RandomPosture(model.tree, random);
  recording.markers.resize(4, 3 * model.marker_count());
  for (double& value : recording.markers.reshaped()) value = random.Normal(1.0);
  recording.markers.block<1, 3>(2, 3).setConstant(std::numeric_limits<double>::quiet_NaN());
  return recording;
}

class Residuals : public ::testing::Test {
 protected:
  ErrorModel model_ = TalosLegModel();
  Recording recording_ = RecordingWithGaps(model_);
  std::vector<int> free_ = FindBaseParameters(model_, {.postures = 100}).kept;
  Eigen::VectorXd fixed_ = Random(2).NormalVector(model_.parameter_count(), 0.01);
  Selection selection_ = SelectAll(model_, recording_);
  std::vector<int> group_ = NoiseGroups(model_, recording_);
  std::vector<PostureLoads> loads_;
  Prior prior_;
  Noise noise_{Eigen::ArrayXXd::Constant(1, kNoiseSourceCount, 0.2e-3)};
  RobustWeights weights_;
  Placement placement_;
  CalibrationOptions options_;
  BodyResiduals problem_{
      {model_, recording_, group_, selection_, loads_, prior_, noise_, weights_, options_},
      free_,
      fixed_,
      placement_};
};

TEST_F(Residuals, UnseenMarkersTakeNoPart) {
  int rows = 0;
  for (int b = 0; b < problem_.body_count(); ++b) rows += problem_.residual_blocks[b].size;
  EXPECT_EQ(rows, 3 * (4 * 9 - 1));
}

TEST_F(Residuals, ErrorsAndUnknownsAreOneToOne) {
  const Eigen::VectorXd x = Random(3).NormalVector(static_cast<Eigen::Index>(free_.size()), 1.0);
  const Eigen::VectorXd delta = problem_.ToErrors(x);
  const BodyResiduals again(
      {model_, recording_, group_, selection_, loads_, prior_, noise_, weights_, options_}, free_,
      delta, placement_);
  EXPECT_LT((again.Start() - x).norm(), 1e-14);
  for (int i = 0; i < model_.parameter_count(); ++i) {
    if (std::binary_search(free_.begin(), free_.end(), i)) continue;
    EXPECT_EQ(delta[i], fixed_[i]) << i;
  }
}

// Residuals are 1e4 (metres over 0.2 mm) and change by about 40 per unit of x. Central differences
// with a step of 1e-4 then have a truncation error of 1e-8 and a rounding error of 1e-8 of the
// Jacobian.
TEST_F(Residuals, JacobianEqualsDifferences) {
  const Eigen::VectorXd x = Random(3).NormalVector(static_cast<Eigen::Index>(free_.size()), 1.0);
  const Eigen::MatrixXd J = DenseJacobian(problem_, x);
  const Eigen::MatrixXd differences = DifferenceJacobian(problem_, x, 1e-4);
  for (Eigen::Index u = 0; u < x.size(); ++u) {
    EXPECT_LT((differences.col(u) - J.col(u)).norm(), 1e-7 * J.norm())
        << model_.parameters[free_[static_cast<std::size_t>(u)]].name;
  }
}

// The markers of a body share its position error. The other rows of the basis have the variance of
// one marker.
TEST_F(Residuals, RowsHaveTheVariancesOfTheirSources) {
  const BodyObservation& body = selection_.bodies.front();
  ASSERT_EQ(body.markers.size(), 3u);
  EXPECT_LT((body.basis.transpose() * body.basis - Eigen::MatrixXd::Identity(9, 9)).norm(), 1e-12);
  const Eigen::VectorXd& sds = problem_.Sds(0);
  for (Eigen::Index row = 0; row < 9; ++row) {
    EXPECT_NEAR(sds[row], 0.2e-3 * (row < 3 ? 2.0 : 1.0), 1e-15) << row;  // 1 + 3 variances
  }
  // A displacement of the body changes only its first three rows.
  Eigen::MatrixXd shift = Eigen::MatrixXd::Zero(9, 1);
  for (int m = 0; m < 3; ++m) shift(3 * m, 0) = 1e-3;
  EXPECT_LT(problem_.Whiten(0, shift).bottomRows(6).norm(), 1e-12);
  // A small rotation about the centre changes only the next three rows.
  Eigen::MatrixXd turn(9, 1);
  Eigen::Matrix3d positions;
  for (int m = 0; m < 3; ++m) {
    positions.col(m) = MarkerPosition(recording_, body.posture, body.markers[m]);
  }
  for (int m = 0; m < 3; ++m) {
    turn.middleRows<3>(3 * m) =
        Eigen::Vector3d(1e-3, 2e-3, -1e-3).cross(positions.col(m) - positions.rowwise().mean());
  }
  const Eigen::VectorXd rows = problem_.Whiten(0, turn);
  EXPECT_LT(rows.head<3>().norm() + rows.tail<3>().norm(), 1e-9 * rows.norm());
}

}  // namespace
}  // namespace elastocal
