// SPDX-License-Identifier: Apache-2.0
// Mistakes in tables of markers, and in projects, that show before any estimate.
#include "elastocal/mistakes/plain_mistakes.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "elastocal/elastocal.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/robot/coupling.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/screening/moved_frame.hpp"
#include "elastocal/screening/told_positions.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "tests/plain_mistakes.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

/// An arm with errors of about a degree in its joints.
class PlainMistakes : public testing::Test {
 protected:
  PlainMistakes() { Record(0.02); }

  void Record(double offset_sd, int postures = 30) {
    const ErrorModel model = MakeErrorModel(project_.tree, project_.markers, project_.placement);
    const BaseParameters base = FindBaseParameters(model, project_.identifiability);
    recorded_ = MakeSyntheticRecording(
        model, DrawErrors(model, base.kept, {{ParameterKind::kTheta, offset_sd}}, 1),
        {.postures = postures});
  }

  /// From this posture on, moves the root link to another place in each posture.
  void MoveRoot(int first) {
    Random random(2);
    for (int i = first; i < recorded_.posture_count(); ++i) {
      const Eigen::Vector3d shift = random.NormalVector(3, 0.1);
      for (int m = 0; m < recorded_.marker_count(); ++m) {
        recorded_.markers.block<1, 3>(i, 3 * m) += shift.transpose();
      }
    }
  }

  std::vector<std::string> Find(const Recording& recording) const {
    return FindPlainMistakes(project_, recording);
  }

  Project project_ = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  Recording recorded_;
};

TEST_F(PlainMistakes, NoneOfACleanTableWhateverItsOffsets) {
  for (const double sd : {0.01, 0.05, 0.2}) {
    Record(sd);
    EXPECT_EQ(First(Find(recorded_)), "") << sd;
  }
}

// If half of the postures of a small arm are wrong, no part of the table places it. Here the
// markers reveal each wrong posture.
TEST_F(PlainMistakes, PositionsModuloHalfATurn) {
  const ErrorModel model = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  const auto flange = std::find_if(project_.tree.joints.begin(), project_.tree.joints.end(),
                                   [](const Joint& joint) { return joint.name == "flange_joint"; });
  const int c = flange->coordinate;
  EXPECT_TRUE(FindHalfTurns(model, recorded_, c).postures.empty());
  const Recording sound = recorded_;
  std::vector<int> off;
  for (int i = 0; i < recorded_.posture_count(); ++i) {
    const double halves = std::round(recorded_.q(i, c) / M_PI);
    if (halves != 0.0) off.push_back(i);
    recorded_.q(i, c) -= halves * M_PI;
  }
  const HalfTurns found = FindHalfTurns(model, recorded_, c);
  EXPECT_EQ(found.postures, off);
  EXPECT_LT((found.turned.q - sound.q).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_EQ(First(Find(recorded_)).find("flange_joint: its positions are off by half a turn in "),
            0u);
}

TEST_F(PlainMistakes, SignsAndExchangesOfAnyJoints) {
  const auto& tree = project_.tree;
  const auto name = [&](int c) { return tree.joints[Size(tree.coordinate_joint[Size(c)])].name; };
  for (const int joint : MakeErrorModel(tree, project_.markers, project_.placement).active_joints) {
    const int c = tree.joints[Size(joint)].coordinate;
    Recording wrong = recorded_;
    wrong.q.col(c) *= -1.0;
    ExpectNamed(Find(wrong), name(c) + ": the sign of its positions is reversed",
                "(--accept sign:" + name(c) + " corrects it)");
  }
  Recording wrong = recorded_;
  wrong.q.col(1).swap(wrong.q.col(4));
  ExpectNamed(Find(wrong), "", ": their positions are exchanged");
}

// Half a turn of a joint may be explained by the sign of the next one. And the nominal robot hardly
// shows a joint that rests while other limbs are measured. The places of the markers tell these
// apart.
TEST_F(PlainMistakes, AnotherZeroOfAnyJoint) {
  const auto& tree = project_.tree;
  for (const int joint : MakeErrorModel(tree, project_.markers, project_.placement).active_joints) {
    const int c = tree.joints[Size(joint)].coordinate;
    const std::string& name = tree.joints[Size(joint)].name;
    SCOPED_TRACE(name);
    if (name == "rail_joint" || name == "flange_joint") continue;  // slides; nothing tells its zero
    Recording wrong = recorded_;
    wrong.q.col(c).array() += M_PI;
    ExpectNamed(Find(wrong), name + ": its positions are off by half a turn in all rows", "");
    wrong.q.col(c).array() -= 1.5 * M_PI;
    ExpectNamed(Find(wrong), name + ": its positions are a quarter of a turn too small", "");
  }
}

TEST_F(PlainMistakes, AllSignsOfALimb) {
  Recording wrong = recorded_;
  wrong.q *= -1.0;
  ExpectNamed(Find(wrong),
              project_.chains[0].name + ": the signs of the positions of all its joints",
              "(--accept sign:");
}

// A column that was not logged is filled with something. One that is right (a joint that was held)
// is not accused of another joint's mistake.
TEST_F(PlainMistakes, AColumnThatIsTheSameInAllRows) {
  for (const int c : {1, 2, 3}) {
    Recording wrong = recorded_;
    wrong.q.col(c).setZero();
    const std::vector<std::string> found = Find(wrong);
    ASSERT_EQ(found.size(), 1u);
    const auto& tree = project_.tree;
    EXPECT_EQ(found[0].find(tree.joints[Size(tree.coordinate_joint[Size(c)])].name +
                            ": its positions are the same in all rows"),
              0u)
        << found[0];
  }
}

TEST_F(PlainMistakes, AJointThatWasHeldIsNotAccused) {
  const ErrorModel model = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  Recording held = recorded_;
  held.q.col(2).setConstant(0.3);
  held.markers = PredictedPositions(model, held, Eigen::VectorXd::Zero(model.parameter_count()),
                                    project_.calibration);
  EXPECT_EQ(First(Find(held)), "");
  for (const int c : {1, 3, 4}) {
    Recording wrong = held;
    wrong.q.col(c) *= 1.3;
    EXPECT_EQ(First(Find(wrong)).find("its positions are the same"), std::string::npos)
        << First(Find(wrong));
  }
}

TEST_F(PlainMistakes, TwoAreNamedBesideEachOther) {
  Recording wrong = recorded_;
  wrong.q.col(1) *= -1.0;
  wrong.q.col(3) *= -1.0;
  const std::vector<std::string> found = Find(wrong);
  ASSERT_EQ(found.size(), 2u) << First(found);
  Measurements measured;
  measured.calibration = wrong;
  std::vector<std::string> names;
  for (const std::string& one : found) {
    const std::size_t begin = one.find("--accept ") + 9;
    names.push_back(one.substr(begin, one.find(' ', begin) - begin));
  }
  AcceptMistakes(project_, names, measured);
  EXPECT_EQ(measured.calibration.q, recorded_.q);
}

// A sound half of the table places the robot.
TEST_F(PlainMistakes, InAPartOfTheTable) {
  const auto& tree = project_.tree;
  const auto name = [&](int c) { return tree.joints[Size(tree.coordinate_joint[Size(c)])].name; };
  Recording wrong = recorded_;
  wrong.q.col(1).tail(12) *= -1.0;
  ExpectNamed(Find(wrong), name(1) + ": the sign of its positions is reversed",
              "in postures 19 to 30");
  wrong = recorded_;
  const Eigen::VectorXd kept = wrong.q.col(1).tail(18);
  wrong.q.col(1).tail(18) = wrong.q.col(3).tail(18);
  wrong.q.col(3).tail(18) = kept;
  ExpectNamed(Find(wrong), name(1) + " and " + name(3) + ": their positions are exchanged",
              "in postures 13 to 30");
  wrong = recorded_;
  for (const int i : {2, 9, 17, 25}) wrong.q(i, 2) += M_PI;
  ExpectNamed(Find(wrong), name(2) + ": its positions are off by half a turn",
              "in postures 3, 10, 18, 26");
  wrong = recorded_;
  for (const int i : {2, 9, 17, 25}) wrong.q(i, 2) = 0.0;
  ExpectNamed(Find(wrong), name(2) + ": its column says the same", "in postures 3, 10, 18, 26");
  wrong = recorded_;
  for (const int i : {2, 9, 17, 25}) wrong.markers.row(i) = recorded_.markers.row(i - 1);
  ExpectNamed(Find(wrong), "the markers are those of the row before", "in postures 3, 10, 18, 26");
}

// Rows without a partner are left out, so that the next mistakes are tried on a shorter table.
TEST_F(PlainMistakes, OneColumnThatIsNotItsOwnAndAFrameOfTheOtherHand) {
  const auto& tree = project_.tree;
  Recording wrong = recorded_;
  wrong.q.col(1).tail(29) = recorded_.q.col(1).head(29);
  ExpectNamed(Find(wrong),
              tree.joints[Size(tree.coordinate_joint[1])].name +
                  ": its positions are those of the row before",
              "");
  wrong = recorded_;
  wrong.q.col(3) += recorded_.q.col(2);
  ExpectNamed(Find(wrong),
              tree.joints[Size(tree.coordinate_joint[3])].name + ": its positions hold those of " +
                  tree.joints[Size(tree.coordinate_joint[2])].name + " as well, added",
              "");
  wrong = recorded_;
  for (int m = 0; m < wrong.marker_count(); ++m) wrong.markers.col(3 * m + 1) *= -1.0;
  ExpectNamed(Find(wrong), "the markers are in a left-handed frame", "");
}

// Each of the two may show only with the other. Three columns that are exchanged in a cycle are two
// exchanges.
TEST_F(PlainMistakes, TwoThatShowOnlyTogether) {
  Recording wrong = recorded_;
  wrong.q.col(1) = recorded_.q.col(2);
  wrong.q.col(2) = recorded_.q.col(3);
  wrong.q.col(3) = recorded_.q.col(1);
  const std::vector<std::string> found = Find(wrong);
  ASSERT_EQ(found.size(), 2u) << First(found);
  for (const std::string& one : found) {
    EXPECT_NE(one.find("(--accept exchange:"), std::string::npos) << one;
  }
}

TEST_F(PlainMistakes, RowsThatAreShifted) {
  for (const int rows : {-2, -1, 1, 2, 3}) {
    Recording wrong = recorded_;
    for (int i = 0; i < wrong.posture_count(); ++i) {
      wrong.q.row(i) = recorded_.q.row((i - rows + wrong.posture_count()) % wrong.posture_count());
    }
    const std::string name = fmt::format("rows:{:+d}", rows);
    ExpectNamed(Find(wrong), "markers belong to the joint positions", "--accept " + name);
    Measurements measured;
    measured.calibration = wrong;
    AcceptMistakes(project_, {name}, measured);
    EXPECT_EQ(measured.calibration.posture_count(), 30 - std::abs(rows));
    EXPECT_EQ(First(Find(measured.calibration)), "");
  }
}

// Offsets of two joints may explain anything. Centimetres that remain are no explanation.
TEST_F(PlainMistakes, NothingIsNamedThatLeavesCentimetres) {
  Measurements measured;
  measured.calibration = recorded_;
  const auto left = [](const RecordedModel&, const Recording& recording) {
    return recording.posture_count() < 30 ? 0.1 : 0.5;
  };
  Recording& wrong = measured.calibration;
  for (int i = 0; i < 30; ++i) wrong.q.row(i) = recorded_.q.row((i + 1) % 30);
  EXPECT_TRUE(FindMistakesBy(project_, {}, measured, 0.5, left).empty());
  const auto explained = [](const RecordedModel&, const Recording& recording) {
    return recording.posture_count() < 30 ? 0.01 : 0.5;
  };
  ASSERT_EQ(FindMistakesBy(project_, {}, measured, 0.5, explained).size(), 1u);
}

TEST_F(PlainMistakes, NothingIsEstimatedOrChosenBesideThem) {
  Recording wrong = recorded_;
  wrong.q.col(2) *= -1.0;
  ScratchFolder scratch;
  WritePostureTable(scratch.path() / "table.csv", wrong, project_.tree);
  const CalibrationRun run = CalibrateExperiment(project_, {scratch.path() / "table.csv"});
  ASSERT_EQ(run.faults.size(), 1u);
  // The effect of the mistake on the fit is not reported as well.
  EXPECT_EQ(run.verdict.objections, run.faults);
  EXPECT_EQ(run.cross_validation.folds, 0);
  EXPECT_TRUE(run.elasticity.empty());
  EXPECT_FALSE(run.urdf.has_value());
}

// The zero of the last joint and the places of its markers have the same effect. Residuals do not
// tell them apart, but the places in the project do.
TEST_F(PlainMistakes, AnotherZeroOfTheLastJointIsToldByThePlacesOfItsMarkers) {
  const auto warned = [&](double zero) {
    Recording recorded = recorded_;
    const Joint& flange = project_.tree.joints[Size(FindJoint(project_.tree, "flange_joint"))];
    recorded.q.col(flange.coordinate).array() += zero;
    ScratchFolder scratch;
    WritePostureTable(scratch.path() / "table.csv", recorded, project_.tree);
    const CalibrationRun run =
        CalibrateExperiment(project_, {scratch.path() / "table.csv"}, {.folds = 0});
    EXPECT_TRUE(run.faults.empty());
    for (const std::string& one : run.warnings) {
      if (one.find("degrees about the axis of flange_joint") != std::string::npos) return one;
    }
    return std::string();
  };
  EXPECT_EQ(warned(0.0), "");
  for (const double zero : {M_PI, 1.2}) {
    const std::string warning = warned(zero);
    EXPECT_EQ(warning.find("cluster TOOL: its markers are "), 0u) << zero << warning;
  }
  EXPECT_EQ(warned(0.1), "");  // 6 degrees: a ruler may err by this
}

TEST_F(PlainMistakes, FollowersThatFollowTheOtherWay) {
  const RobotTree free = project_.tree;
  const int leads = 1, follows = 3;
  project_.tree = Couple(free, {{follows, {{leads, 0.5}}, 0.0}});
  Record(0.02);
  EXPECT_EQ(First(Find(recorded_)), "");
  project_.tree = Couple(free, {{follows, {{leads, -0.5}}, 0.0}});
  const std::string joint = free.joints[Size(follows)].name, of = free.joints[Size(leads)].name;
  ExpectNamed(Find(recorded_),
              joint + " seems to follow " + of + " by a factor of 0.5, not -0.5 as described",
              "(couplings of the project, mimic of the URDF)");
}

TEST_F(PlainMistakes, ARootThatMoved) {
  MoveRoot(0);
  ExpectNamed(Find(recorded_), "the root link seems to stand elsewhere in each posture",
              "{root: free}");
}

// The tripod turns by 4 mrad: markers on the pedestal hardly move, the hand moves by millimetres.
TEST_F(PlainMistakes, AFrameOfTheMarkersThatMovedIsToldByTheRootsMarkers) {
  Recording pushed = recorded_;
  const Eigen::Matrix3d R = RotationFromVector({0.0, 0.0, 4e-3});
  for (int i = 14; i < pushed.posture_count(); ++i) {
    for (int m = 0; m < pushed.marker_count(); ++m) {
      pushed.markers.block<1, 3>(i, 3 * m) *= R.transpose();
    }
  }
  const std::vector<std::string> found = Find(pushed);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].find("from posture 15 on the frame of the markers lies elsewhere"), 0u)
      << found[0];
  EXPECT_NE(found[0].find(" 4"), std::string::npos);
  const auto moved =
      FindMovedFrame(MakeErrorModel(project_.tree, project_.markers, project_.placement), pushed);
  ASSERT_TRUE(moved);
  EXPECT_NEAR(moved->angle, 4e-3, 0.5e-3);
}

TEST_F(PlainMistakes, AMarkerOfTheRootThatSlippedIsNoMovedFrame) {
  Recording slipped = recorded_;
  for (int i = 14; i < slipped.posture_count(); ++i) slipped.markers(i, 0) += 5e-3;
  const ErrorModel model = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  ASSERT_EQ(project_.tree.links[static_cast<std::size_t>(model.markers[0].link)].body, 0);
  EXPECT_FALSE(FindMovedFrame(model, slipped));
  EXPECT_FALSE(FindMovedFrame(model, recorded_));
}

// Only some postures of a long table are fitted, from all its parts.
TEST_F(PlainMistakes, ARootThatMovedAtTheEndOfALongTable) {
  Record(0.02, 700);
  MoveRoot(500);
  ExpectNamed(Find(recorded_), "the root link seems to stand elsewhere in each posture",
              "{root: free}");
}

}  // namespace
}  // namespace elastocal
