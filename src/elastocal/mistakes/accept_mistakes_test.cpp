// SPDX-License-Identifier: Apache-2.0
// Mistakes that are undone together, on request.
#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/mistakes/tried_correction.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

constexpr int kPlayed = 24;  // postures of a trial
constexpr double kTwoDegrees = 2.0 * M_PI / 180.0;

class AcceptedMistakes : public testing::Test {
 protected:
  AcceptedMistakes() {
    Recording& recording = measured_.calibration;
    recording.trials = {{"swing", TrialKind::kCalibration, {project_.chains.front().name}}};
    recording.trial.assign(kPlayed, 0);
    for (const Marker& marker : project_.markers) recording.marker_names.push_back(marker.name);
    Random random(3);
    recording.q.resize(kPlayed, project_.tree.coordinate_count());
    for (double& position : recording.q.reshaped()) position = 0.3 * random.Normal(1.0);
    See();
  }

  /// Sets the markers to where the positions put them, and keeps these as the truth.
  void See() {
    Recording& recording = measured_.calibration;
    recording.markers.setZero(recording.posture_count(), 3 * recording.marker_count());
    const ErrorModel model = NominalModel(project_, recording);
    const Geometry geometry = ApplyErrors(model, Eigen::VectorXd::Zero(model.parameter_count()));
    for (int i = 0; i < recording.posture_count(); ++i) {
      recording.markers.row(i) =
          MarkerPositions(model, geometry, recording.q.row(i).transpose()).reshaped().transpose();
    }
    truth_ = recording.q;
  }

  int CoordinateOf(const std::string& joint) const {
    return project_.tree.joints[FindJoint(project_.tree, joint)].coordinate;
  }

  Eigen::MatrixXd Accepted(const std::vector<std::string>& names) const {
    Measurements measured = measured_;
    AcceptMistakes(project_, names, measured);
    return measured.calibration.q;
  }

  const Project project_ = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  Measurements measured_;
  Eigen::MatrixXd truth_;
};

// The offset was told without the sign, so that it is that of the right positions.
// The gain was told without the exchange, so that it is that of the right column.
TEST_F(AcceptedMistakes, AGainIsUndoneAfterAnExchange) {
  Eigen::MatrixXd& q = measured_.calibration.q;
  const int a = CoordinateOf("turret_joint"), b = CoordinateOf("elbow_joint");
  q.col(a) *= 1.05;
  q.col(a).swap(q.col(b));
  const std::string gain = "gain:turret_joint=1.05";
  const std::string exchange = "exchange:elbow_joint,turret_joint";
  EXPECT_LT((Accepted({gain, exchange}) - truth_).norm(), 1e-9);
  EXPECT_LT((Accepted({exchange, gain}) - truth_).norm(), 1e-9);
}

TEST_F(AcceptedMistakes, AnOffsetIsUndoneAfterASign) {
  Eigen::MatrixXd& q = measured_.calibration.q;
  const int a = CoordinateOf("elbow_joint");
  q.col(a) = -(q.col(a).array() + kTwoDegrees);
  const std::string offset = "offset:elbow_joint@swing=2", sign = "sign:elbow_joint";
  EXPECT_LT((Accepted({offset, sign}) - truth_).norm(), 1e-9);
  EXPECT_LT((Accepted({sign, offset}) - truth_).norm(), 1e-9);
}

// Postures are counted without those in which another joint was frozen.
TEST_F(AcceptedMistakes, AnOffsetFromAPostureOnIsUndoneAfterAFrozenPart) {
  Eigen::MatrixXd& q = measured_.calibration.q;
  const int a = CoordinateOf("shoulder_joint"), b = CoordinateOf("elbow_joint");
  q.col(b).segment(4, 6).setConstant(q(4, b));
  const Eigen::Index frozen = kPlayed - Accepted({"frozen:elbow_joint"}).rows();
  ASSERT_GE(frozen, 5);
  q.col(a).tail(kPlayed - 15).array() += kTwoDegrees;
  const std::string offset = "offset:shoulder_joint@swing:" + std::to_string(16 - frozen) + "=2";
  const Eigen::MatrixXd undone = Accepted({offset, "frozen:elbow_joint"});
  ASSERT_EQ(undone.rows(), kPlayed - frozen);
  EXPECT_LT((undone.bottomRows(12) - truth_.bottomRows(12)).norm(), 1e-9);
}

}  // namespace
}  // namespace elastocal
