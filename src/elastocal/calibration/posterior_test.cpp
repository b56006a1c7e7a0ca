// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/calibration/fit.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/robot/jacobian.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

class PosteriorTest : public ::testing::Test {
 protected:
  void SetUp() override {
    Random random(4);
    recording_.q.resize(12, model_.tree.coordinate_count());
    for (int i = 0; i < 12; ++i) recording_.q.row(i) = RandomPosture(model_.tree, random);
    recording_.markers.setZero(12, 27);
    for (const Marker& marker : model_.markers) recording_.marker_names.push_back(marker.name);
    mask_.setConstant(12, 9, true);
    mask_(3, 4) = false;
    delta_ = random.NormalVector(model_.parameter_count(), 1e-3);
    for (const char* name : {"leg_3.theta", "leg_4.d", "marker.FOOT_1.x"}) {
      parameters_.push_back(FindParameter(model_.parameters, name));
    }
  }

  /// The information of the data, from the dense Jacobians.
  Eigen::Matrix3d Information(double marker_sd) const {
    GeneralizedJacobian jacobian(model_);
    const Geometry geometry = ApplyErrors(model_, delta_);
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 12; ++i) {
      jacobian.Evaluate(geometry, recording_.q.row(i).transpose());
      const Eigen::MatrixXd J = jacobian.Dense()(Eigen::all, parameters_);
      for (int m = 0; m < 9; ++m) {
        if (!mask_(i, m)) continue;
        information += J.middleRows<3>(3 * m).transpose() * J.middleRows<3>(3 * m);
      }
    }
    return information / (marker_sd * marker_sd);
  }

  /// Posterior with the given noise, of which the markers of a body share none.
  Posterior Compute(double marker_sd) const {
    const std::vector<char> tied(12, 1);
    const Selection selection = Select(model_, recording_, mask_, tied);
    CalibrationOptions options;
    options.marker_sd = marker_sd;
    const FitProblem problem{model_, recording_, options, std::vector<int>(12, 0)};
    Fit fit = StartFit(problem, selection, delta_);
    fit.noise(0, NoiseSource::kBodyPosition) = 1e-6 * marker_sd;
    UpdatePosterior(problem, selection, parameters_, fit);
    return fit.posterior;
  }

  ErrorModel model_ = TalosLegModel();
  Recording recording_;
  ObservationMask mask_;
  Eigen::VectorXd delta_;
  std::vector<int> parameters_;
  Prior prior_;
};

TEST_F(PosteriorTest, CovarianceIsTheInverseOfDataAndPriorInformation) {
  constexpr double kMarkerSd = 5e-3;
  Eigen::Matrix3d information = Information(kMarkerSd);
  information(0, 0) += std::pow(prior_[ParameterKind::kTheta], -2);
  information(1, 1) += std::pow(prior_[ParameterKind::kD], -2);
  information(2, 2) += 1.0;  // prior of a metre: the position of a marker is unknown
  const Posterior posterior = Compute(kMarkerSd);
  // The recording has all markers at the origin, so that its postures scatter beyond all bounds.
  // The scatter is added to the data's part of the covariance.
  const Eigen::Matrix3d inverse = information.inverse();
  const Eigen::Matrix3d expected =
      inverse + (posterior.cluster_factor - 1.0) * inverse * Information(kMarkerSd) * inverse;
  EXPECT_GT(posterior.cluster_factor, 1.0);
  EXPECT_LT((posterior.covariance - expected).norm(), 1e-9 * expected.norm());
}

TEST_F(PosteriorTest, EffectiveParametersGoFromNoneToAll) {
  // Exact measurements determine all parameters. Worthless ones leave all of them to the prior.
  EXPECT_NEAR(Compute(1e-6).effective_parameters, 3.0, 1e-4);
  EXPECT_NEAR(Compute(1e4).effective_parameters, 0.0, 1e-4);
}

TEST(StrongCorrelations, StrongestFirstAndNoneBelowTheThreshold) {
  Posterior posterior;
  posterior.parameters = {4, 7, 9};
  posterior.covariance.resize(3, 3);
  posterior.covariance << 4.0, 1.9, 0.5, 1.9, 1.0, -0.92, 0.5, -0.92, 1.0;
  const std::vector<Correlation> strong = StrongCorrelations(posterior, 0.9);
  ASSERT_EQ(strong.size(), 2u);
  EXPECT_EQ(strong[0].first, 4);
  EXPECT_EQ(strong[0].second, 7);
  EXPECT_DOUBLE_EQ(strong[0].coefficient, 0.95);
  EXPECT_DOUBLE_EQ(strong[1].coefficient, -0.92);
}

}  // namespace
}  // namespace elastocal
