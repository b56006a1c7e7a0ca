// SPDX-License-Identifier: Apache-2.0
// Messages about faults that remain after a fit and are not one simple fault.
#include "elastocal/mistakes/general_fault.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/calibration/prediction.hpp"
#include "elastocal/elastocal.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/mistakes/find_faults.hpp"
#include "elastocal/mistakes/up_by_loads.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/screening/carrying_link.hpp"
#include "elastocal/screening/coarse_positions.hpp"
#include "elastocal/screening/loose_clusters.hpp"
#include "elastocal/screening/odd_postures.hpp"
#include "elastocal/screening/recording_faults.hpp"
#include "tests/faulty_arm.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

using GeneralFaults = FaultyArm;

// The first guess is a single slip, larger than either and near the second one.
TEST_F(GeneralFaults, AJointThatSlipsTwiceIsSaidToSlipTwice) {
  EXPECT_EQ(Said(), "");
  Turn("elbow_joint", 16, 48, 0.7);
  Turn("elbow_joint", 33, 48, 0.7);
  const std::string said = Said();
  ExpectIn(said, "offset:elbow_joint:17=0.");
  ExpectIn(said, " offset:elbow_joint:34=0.");
}

TEST_F(GeneralFaults, AJointThatSlipsAndIsSetRightIsOffInBetween) {
  Turn("shoulder_joint", 15, 27, 1.2);
  const std::string said = Said();
  ExpectIn(said, "from posture 16 to posture 27 (--accept offset:shoulder_joint:16=1.");
  ExpectIn(said, " offset:shoulder_joint:28=-1.");
}

TEST_F(GeneralFaults, AnEncoderThatDriftsIsNoSlip) {
  const int c = CoordinateOf("turret_joint");
  recorded_.q.col(c) += Eigen::VectorXd::LinSpaced(48, 0.0, 1.0 * kDegree);
  const std::string said = Said(), begin = "turret_joint: its positions drift by ";
  ASSERT_EQ(said.find(begin), 0u) << said;
  EXPECT_NEAR(std::stod(said.substr(begin.size())), 1.0, 0.15) << said;  // sd 0.06
}

TEST_F(GeneralFaults, ADriftInOneTrialIsNamedWithIt) {
  recorded_.trials = {{"first", TrialKind::kCalibration, {project_.chains.front().name}},
                      {"second", TrialKind::kCalibration, {project_.chains.front().name}}};
  recorded_.trial.assign(48, 0);
  std::fill(recorded_.trial.begin() + 24, recorded_.trial.end(), 1);
  EXPECT_EQ(Said(), "");
  recorded_.q.col(CoordinateOf("elbow_joint")).head(24) +=
      Eigen::VectorXd::LinSpaced(24, 0.0, 1.5 * kDegree);
  const std::string said = Said(), begin = "elbow_joint: its positions drift by ";
  ASSERT_EQ(said.find(begin), 0u) << said;
  EXPECT_NEAR(std::stod(said.substr(begin.size())), 1.5, 0.2) << said;
  ExpectIn(said, "from the first posture to the last of trial first");
}

// The derivative is taken at the wrong gain, far from the right one.
TEST_F(GeneralFaults, AGainOfHalfIsFoundAsHalf) {
  recorded_.q.col(CoordinateOf("elbow_joint")) *= 0.5;
  const std::string said = Said(), begin = "elbow_joint: its positions are ";
  ASSERT_EQ(said.find(begin), 0u) << said;
  EXPECT_NEAR(std::stod(said.substr(begin.size())), 0.5, 0.005) << said;  // sd 0.0009
}

// With a worn encoder, postures have independent errors.
TEST_F(GeneralFaults, PositionsOfOneJointThatScatterAreNamed) {
  const auto scattered = [&] {
    return FindScatteredPositions(Calibrate(model_, recorded_, base_, kKind, project_.calibration),
                                  recorded_, project_.calibration);
  };
  EXPECT_FALSE(scattered());
  Random random(5);
  recorded_.q.col(CoordinateOf("elbow_joint")) += random.NormalVector(48, 1.2 * kDegree);
  EXPECT_EQ(Said(), "");
  const auto found = scattered();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->coordinate, CoordinateOf("elbow_joint"));
  EXPECT_TRUE(IsTooLoose(*found, project_.tree));
  EXPECT_FALSE(IsTooLoose({found->coordinate, 0.3 * kDegree, found->left}, project_.tree));
  // The error is estimated by the median of 48 draws, and the fit follows a part of them.
  EXPECT_NEAR(found->off, 1.0 * kDegree, 0.5 * kDegree);
}

// Another trial has another zero. An error that all postures of a trial share is no scatter.
TEST_F(GeneralFaults, AJointThatIsOffThroughoutATrialDoesNotScatter) {
  recorded_.trials = {{"first", TrialKind::kCalibration, {project_.chains.front().name}},
                      {"second", TrialKind::kCalibration, {project_.chains.front().name}}};
  recorded_.trial.assign(48, 0);
  std::fill(recorded_.trial.begin() + 24, recorded_.trial.end(), 1);
  recorded_.q.col(CoordinateOf("elbow_joint")).tail(24).array() += 1.5 * kDegree;
  const auto found =
      FindScatteredPositions(Calibrate(model_, recorded_, base_, kKind, project_.calibration),
                             recorded_, project_.calibration);
  EXPECT_FALSE(found) << (found ? Describe(*found, project_.tree) : "");
}

// The joint is for instance a neck while a leg is measured. A force on a hand that no camera sees
// bends the shoulder by some hundredths of a millimetre. Loads of another attitude of the hand
// would do the same.
TEST_F(GeneralFaults, AJointWhoseMarkersAreOutOfSightDoesNotScatter) {
  const int shoulder = project_.tree.coordinate_joint[CoordinateOf("shoulder_joint")];
  const int bend = CoordinateOf("bend_joint");
  const ErrorModel model =
      MakeErrorModel(project_.tree, project_.markers, project_.placement, {.torsion = {shoulder}});
  CalibrationResult fit =
      Calibrate(model, recorded_, FindBaseParameters(model, project_.identifiability),
                ModelKind::kFull, project_.calibration);
  fit.delta += ErrorsByName(fit.model, {{"shoulder_joint.compliance_z", 2e-4}});
  Recording pulled = recorded_;
  Random random(5);
  pulled.q.col(bend).tail(30) += random.NormalVector(30, 5.0 * kDegree);
  const Eigen::MatrixXd positions =
      Predict(fit.model, fit.delta, pulled, project_.calibration, &fit.placement).positions;
  recorded_.markers = positions;
  for (int m = 0; m < recorded_.marker_count(); ++m) {
    const std::string& name = recorded_.marker_names[m];
    if (name.rfind("FOREARM", 0) == 0 || name.rfind("PEDESTAL", 0) == 0) continue;
    recorded_.markers.block(18, 3 * m, 30, 3).setConstant(std::nan(""));
  }
  const auto found = FindScatteredPositions(fit, recorded_, project_.calibration);
  EXPECT_FALSE(found) << (found ? Describe(*found, project_.tree) : "");
}

TEST_F(GeneralFaults, AnotherRobotIsNoSlipOfAJoint) {
  const Recording other = Record(model_, base_.kept, 7);
  recorded_.markers.bottomRows(20) = other.markers.bottomRows(20);
  const std::string said = Said();
  ExpectIn(said, "positions of several joints are off from posture 2");
  EXPECT_EQ(said.find("--accept"), std::string::npos) << said;
}

TEST_F(GeneralFaults, AKnockedClusterIsNoSlipOfAJoint) {
  ErrorModel knocked = model_;
  for (Marker& marker : knocked.markers) {
    if (marker.name.rfind("TOOL", 0) == 0) {
      marker.p_link_marker = Eigen::AngleAxisd(0.07, Eigen::Vector3d(0.6, 0.5, -0.6).normalized()) *
                                 marker.p_link_marker +
                             Eigen::Vector3d(6e-3, -5e-3, 4e-3);
    }
  }
  const Recording other = Record(knocked, base_.kept, 1);
  recorded_.markers.bottomRows(28) = other.markers.bottomRows(28);
  ExpectIn(Said(), "cluster TOOL: its markers seem to be elsewhere on their link from posture 2");
}

TEST_F(GeneralFaults, ATrackerThatWasPushedAlongTwoAxesIsOneSentence) {
  for (int m = 0; m < recorded_.marker_count(); ++m) {
    recorded_.markers.col(3 * m).tail(28).array() += 6e-3;
    recorded_.markers.col(3 * m + 1).tail(28).array() -= 5e-3;
  }
  const std::string said = Said();
  ExpectIn(said, "the frame of the markers lies ");
  ExpectIn(said, " mm elsewhere ([6.0, -5.0, ");
  EXPECT_EQ(said.find("pushed"), said.rfind("pushed")) << said;
}

// The displacement of one cluster looks a little like one of the cameras' frame.
TEST_F(GeneralFaults, AKnockedClusterIsNoPushedTracker) {
  ErrorModel knocked = model_;
  for (Marker& marker : knocked.markers) {
    if (marker.name.starts_with("TOOL")) marker.p_link_marker += Eigen::Vector3d(6e-3, -5e-3, 4e-3);
  }
  recorded_.markers.bottomRows(28) = Record(knocked, base_.kept, 1).markers.bottomRows(28);
  const RecordingFault pushed{.kind = FaultKind::kFrameShift,
                              .posture = 20,
                              .size = 3e-3,
                              .sd = 1e-4,
                              .along = Eigen::Vector3d::UnitZ()};
  const std::string said =
      ExplainFault({pushed, model_, base_, recorded_, kKind, project_.calibration}, project_).text;
  ExpectIn(said, "cluster TOOL: its markers seem to be elsewhere on their link from posture 21");
}

// The slip distorts the first fit. Its size is that of a fit that corrects it. It is compared with
// a displacement of the cluster itself, which has more numbers.
TEST_F(GeneralFaults, TheSizeOfALargeSlipIsThatOfTheLastFit) {
  Turn("flange_joint", 20, 48, 8.0);
  const std::string said = Said(), begin = "flange_joint: its positions are off by ", sign = " +- ";
  ASSERT_EQ(said.find(begin), 0u) << said;
  const double sd = std::stod(said.substr(said.find(sign) + sign.size()));
  EXPECT_LT(sd, 0.1) << said;
  EXPECT_NEAR(std::stod(said.substr(begin.size())), 8.0, 3.0 * sd) << said;
}

// The lengths of a robot have no direction in the room.
TEST_F(GeneralFaults, AScaleOfOneAxisOfTheCameras) {
  for (int m = 0; m < recorded_.marker_count(); ++m) recorded_.markers.col(3 * m + 2) *= 1.01;
  ExpectIn(Said(), "camera positions along z are 1.0");
}

TEST_F(GeneralFaults, CamerasWhoseAxesAreNotSquare) {
  for (int m = 0; m < recorded_.marker_count(); ++m) {
    recorded_.markers.col(3 * m + 1) += 0.006 * recorded_.markers.col(3 * m + 2);
  }
  ExpectIn(Said(), "the cameras' axes are not square: y is off by 0.006");
}

TEST_F(GeneralFaults, CamerasWhoseScaleChangesOutwards) {
  const RecordingFault bend{.kind = FaultKind::kCameraBend};
  recorded_.markers += 0.01 * CameraDisplacements(bend, recorded_);
  ExpectIn(Said(), "the cameras' space is distorted: their scale at the outermost marker is 1.0");
}

// The log has the commanded positions. The markers were measured before the robot came to rest.
TEST_F(GeneralFaults, ATableThatWasMeasuredBeforeRest) {
  for (int i = 1; i < 48; ++i) {
    recorded_.q.row(i) = (recorded_.q.row(i) - 0.015 * recorded_.q.row(i - 1)) / 0.985;
  }
  ExpectIn(Said(), "the joints: positions are ahead of the markers by 1.5");
}

TEST_F(GeneralFaults, OneJointThatIsLoggedLate) {
  const int c = CoordinateOf("flange_joint");
  const Eigen::VectorXd column = recorded_.q.col(c);
  recorded_.q.col(c).tail(47) -= 0.05 * (column.tail(47) - column.head(47));
  ExpectIn(Said(), "flange_joint: positions are behind the markers by ");
}

// If a robot was commanded to round numbers, they are as good a record as any others.
TEST_F(GeneralFaults, ARoundedColumnIsOneWhosePositionsAreElsewhere) {
  const int c = CoordinateOf("elbow_joint");
  const auto found = [&] {
    const CalibrationResult fit = Calibrate(model_, recorded_, base_, kKind, project_.calibration);
    return FindCoarsePositions(fit, recorded_, project_.calibration, {});
  };
  EXPECT_TRUE(found().empty());
  const Eigen::VectorXd rounded = (recorded_.q.col(c) / kDegree).array().round() * kDegree;
  recorded_.q.col(c) = rounded;
  const auto coarse = found();
  ASSERT_EQ(coarse.size(), 1u);
  EXPECT_EQ(coarse[0].coordinate, c);
  EXPECT_NEAR(coarse[0].step, kDegree, 1e-9);
  EXPECT_NEAR(coarse[0].off, kDegree / std::sqrt(12.0), 0.1 * kDegree);  // 48 of them: sd 0.02
  const CalibrationResult fit = Calibrate(model_, recorded_, base_, kKind, project_.calibration);
  recorded_.markers = Predict(model_, fit.delta, recorded_, project_.calibration).positions;
  EXPECT_TRUE(found().empty());
}

// These errors are far below those of the nominal robot.
TEST_F(GeneralFaults, AJointThatIsElsewhereInFewRows) {
  const std::vector<LabelCluster> none;
  const auto odd = [&] {
    const CalibrationResult fit = Calibrate(model_, recorded_, base_, kKind, project_.calibration);
    return FindOddPostures(model_, recorded_, none, &fit.delta);
  };
  EXPECT_TRUE(odd().empty());
  for (const int i : {7, 18, 30, 41}) Turn("flange_joint", i, i + 1, 5.0);
  EXPECT_TRUE(FindOddPostures(model_, recorded_, none).empty());
  const auto found = odd();
  ASSERT_EQ(found.size(), 1u);
  ExpectIn(found[0].what, "flange_joint: its positions are wrong");
  ExpectIn(found[0].what, "in postures 8, 19, 31, 42");
}

// The error grows with the distance from the zero, but makes only few postures odd.
TEST_F(GeneralFaults, AGainIsNoOddPosture) {
  recorded_.q.col(CoordinateOf("turret_joint")) *= 0.97;
  for (const OddPostures& one :
       FindOddPostures(model_, recorded_, SeenClusters(project_, recorded_))) {
    ADD_FAILURE() << one.what;
  }
  EXPECT_EQ(Said().find("turret_joint: its positions are 0.97"), 0u) << Said();
}

// If a fit left out many outliers, other unknowns explain most of the squares. A fault is judged by
// its share of what these leave.
TEST_F(GeneralFaults, AFitThatIsFarFromTheDataHidesNoGain) {
  const CalibrationResult fit = Calibrate(model_, recorded_, base_, kKind, project_.calibration);
  recorded_.q.col(CoordinateOf("elbow_joint")) *= 1.01;
  Turn("turret_joint", 0, 48, 3.0);  // in all postures, so an error of the robot
  const auto found = FindRecordingFaults(fit, recorded_, project_.calibration);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].kind, FaultKind::kJointGain);
  EXPECT_EQ(found[0].coordinate, CoordinateOf("elbow_joint"));
  EXPECT_NEAR(found[0].size, 0.01, 0.001);  // after one linear step
}

// In ten postures, most of the noise that would judge the gain is the gain itself.
TEST_F(GeneralFaults, AGainIsJudgedByTheNoiseWithoutIt) {
  recorded_ = SelectPostures(recorded_, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
  EXPECT_EQ(Said(), "");
  recorded_.q.col(CoordinateOf("bend_joint")) *= 1.01;
  ExpectIn(Said(), "bend_joint: its positions are 1.01");
}

// Half a percent is little for a gear, but much for a lead screw or the scale of the cameras.
TEST_F(GeneralFaults, AGainOfASlideCountsFromAFifthOfAPercentOn) {
  recorded_.q.col(CoordinateOf("rail_joint")) *= 1.003;
  const std::string said = Said();
  ExpectIn(said, "rail_joint: its positions are 1.003");
  ExpectIn(said, "if its scale is right, the cameras' is 0.99");
}

// A loosely fixed plate or a swinging base moves markers like this.
TEST_F(GeneralFaults, MarkersThatAreElsewhereInEachPostureAreNamed) {
  const auto said = [&](const std::vector<std::string>& clusters, double sd) -> std::string {
    Random random(4);
    Recording moved = recorded_;
    for (int i = 0; i < moved.posture_count(); ++i) {
      const Eigen::RowVector3d by = random.NormalVector(3, sd).transpose();
      for (int m = 0; m < moved.marker_count(); ++m) {
        const std::string& name = moved.marker_names[static_cast<std::size_t>(m)];
        const bool is_moved = std::any_of(clusters.begin(), clusters.end(),
                                          [&](const auto& one) { return name.starts_with(one); });
        if (is_moved) moved.markers.block<1, 3>(i, 3 * m) += by;
      }
    }
    std::vector<LabelCluster> rigid = SeenClusters(project_, moved);
    if (clusters.size() > 1) {
      // Two single markers that are seen in few postures say nothing, and forbid nothing.
      const auto wrist = std::ranges::find(moved.marker_names, "WRIST");
      const auto single = static_cast<int>(wrist - moved.marker_names.begin());
      moved.markers.block(3, 3 * single, 45, 3).setConstant(std::nan(""));
      rigid.push_back({"PAIR", {single, single}});
    }
    const auto loose =
        FindLooseCluster(Calibrate(model_, moved, base_, kKind, project_.calibration), moved, rigid,
                         project_.calibration);
    return loose ? Describe(*loose) + (IsTooLoose(*loose) ? " too loose" : "") : "";
  };
  EXPECT_EQ(said({}, 0.0), "");
  const std::string cluster = said({"FOREARM"}, 5e-3), little = said({"TOOL"}, 8e-4),
                    robot = said({"FOREARM", "WRIST", "TOOL"}, 2e-3);
  EXPECT_EQ(cluster.find("cluster FOREARM: its markers are elsewhere"), 0u) << cluster;
  ExpectIn(cluster, "too loose");
  EXPECT_EQ(little.find("cluster TOOL: its markers are elsewhere"), 0u) << little;
  EXPECT_EQ(little.find("too loose"), std::string::npos) << little;
  EXPECT_EQ(robot.find("the robot as a whole is elsewhere"), 0u) << robot;
}

TEST_F(GeneralFaults, MarkersOnAnotherLinkThanTheProjectSaysAreNamedWithIt) {
  std::vector<Marker> markers = project_.markers;
  for (Marker& marker : markers) {
    if (marker.name.starts_with("FOREARM")) marker.link = FindLink(project_.tree, "upper_arm");
  }
  const ErrorModel truth = MakeErrorModel(project_.tree, markers, project_.placement);
  const Recording recorded = MakeSyntheticRecording(
      truth, Eigen::VectorXd::Zero(truth.parameter_count()), {.postures = 48, .seed = 3});
  std::vector<LabelCluster> clusters = SeenClusters(project_, recorded);
  const auto forearm = std::ranges::find(clusters, "FOREARM", &LabelCluster::name)->markers;
  clusters.push_back({"PAIR", {forearm[0], forearm[1]}});  // two markers do not tell
  const auto found = FindCarryingLink(model_, recorded, clusters);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->cluster, "FOREARM");
  EXPECT_EQ(found->own, "forearm");
  EXPECT_EQ(found->carrier, "upper_arm");
  EXPECT_LT(found->on_carrier, 1e-3);
  EXPECT_FALSE(FindCarryingLink(model_, recorded_, SeenClusters(project_, recorded_)));
  // A joint whose positions are wrong moves several clusters.
  recorded_.q.col(CoordinateOf("turret_joint")).setZero();
  EXPECT_FALSE(FindCarryingLink(model_, recorded_, SeenClusters(project_, recorded_)));
}

// With -z up, springs replace a part of a gain and a slip. With z up, both together explain all.
TEST_F(GeneralFaults, AGainBesideASlipIsNoOtherAxisUp) {
  recorded_.q.col(CoordinateOf("shoulder_joint")) *= 1.025;
  Turn("elbow_joint", 26, 48, -1.5);
  Measurements measured;
  measured.calibration = recorded_;
  ASSERT_TRUE(FindUpByLoads(project_, {}, measured, 1.0));
  const ModelComparison comparison =
      CompareModels(Calibrate(model_, recorded_, base_, kKind, project_.calibration), model_,
                    recorded_, base_, project_.calibration);
  const std::vector<std::string> said =
      FindFaults(project_, {}, measured, {model_, base_}, recorded_, comparison);
  ASSERT_EQ(said.size(), 1u);
  ExpectIn(said[0], "gain:shoulder_joint=1.02");
  ExpectIn(said[0], " offset:elbow_joint:27=-1.");
}

}  // namespace
}  // namespace elastocal
