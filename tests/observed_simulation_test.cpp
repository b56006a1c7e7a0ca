// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/observation/observed_posture.hpp"
#include "elastocal/pipeline/contact_check.hpp"
#include "elastocal/planning/design_observations.hpp"
#include "elastocal/planning/plan_motion.hpp"
#include "elastocal/planning/simulate_observations.hpp"
#include "elastocal/simulation/level_feet.hpp"
#include "tests/arm_with_tracker.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

Project TouchProject() { return ReadProject(SourceFile("examples/talos_touch/project.yaml")); }

/// Options for a rigid robot with errors only in the zeros of its joints, and perfect instruments.
VirtualExperimentOptions OffsetsAlone() {
  VirtualExperimentOptions options;
  SwitchOffImperfections(options);
  options.truth.upper_geometry_scale = options.truth.leg_geometry_scale = 1.0;
  options.truth.length_sd = options.truth.angle_sd = 0.0;
  options.instruments.table_height_sd = 5e-3;
  return options;
}

/// Residuals of the estimator's model with the true values, for measurements of MuJoCo's robot.
struct Comparison {
  ObservedRecording recording;
  ObservedRobot model;
  Observations all;
  std::vector<Eigen::VectorXd> left;
};

Comparison Compare(const Project& project, const std::vector<ChainPostures>& postures,
                   const VirtualExperimentOptions& options) {
  Comparison of{SimulateObservations(project, postures, options), {}, {}, {}};
  const TrueRobot& robot = of.recording.robot.robot;
  // The right foot stands where the true robot has put it.
  ObservationSetup setup = of.recording.setup;
  const ObservedPostureSampler stance(project, 0);
  const LevelFeet feet(robot, stance.support(), stance.robot().rest);
  setup.feet[1].T_floor_foot = feet.T_floor_foot()[1];
  of.model = MakeObservedRobot(project.tree, project.placement, setup, {}, {});
  ObservedValues truth;
  truth.robot = Eigen::VectorXd::Zero(of.model.robot.parameter_count());
  truth.quantities = of.recording.quantities;
  for (int i = 0; i < of.model.robot.parameter_count(); ++i) {
    const Parameter& parameter = of.model.robot.parameters[Size(i)];
    if (parameter.kind == ParameterKind::kTheta && of.model.unknown[Size(i)] >= 0) {
      truth.robot[i] = robot.offset[parameter.joint];
    }
  }
  const int count = static_cast<int>(of.recording.postures.size());
  of.all.q.resize(count, project.tree.coordinate_count());
  for (int i = 0; i < count; ++i) {
    const SimulatedPosture& seen = of.recording.postures[Size(i)];
    of.all.postures.push_back({0, i});
    of.all.q.row(i) = seen.encoders.transpose();
    if (seen.plate >= 0) of.all.all.push_back({i, seen.plate, {}, {}});
    for (int n = 0; n < static_cast<int>(seen.measured.size()); ++n) {
      if (seen.measured[Size(n)].size() == 0 || seen.plate >= 0) continue;
      of.all.all.push_back({i, n, seen.measured[Size(n)], {}});
    }
  }
  of.left = LeftOf(of.model, of.all, truth);
  return of;
}

TEST(SimulateObservations, MuJoCoShowsInstrumentsWhatTheModelWithTheTruthPredicts) {
  const Project project = TouchProject();
  ObservationDesign drawn = DrawObservedPostures(project, 2, 3);
  ASSERT_TRUE(drawn.infeasible.empty()) << drawn.infeasible;
  const Comparison of = Compare(project, {drawn.postures.back()}, OffsetsAlone());
  int views = 0;
  for (std::size_t i = 0; i < of.left.size(); ++i) {
    const Instrument& instrument = of.model.instrument(of.all.all[i].instrument);
    const bool image = instrument.measured_size() == 8;
    // Units are px or m/s^2. Offsets of a degree would be 10 px and 0.2 m/s^2.
    EXPECT_LT(of.left[i].cwiseAbs().maxCoeff(), image ? 0.3 : 3e-3) << instrument.name;
    views += image ? 1 : 0;
  }
  EXPECT_GT(views, 0);
}

TEST(SimulateObservations, MuJoCosContactLaysPlatesFlushOnTheTrueTables) {
  const Project project = TouchProject();
  const ObservationDesign drawn = DrawObservedPostures(project, 2, 3);
  VirtualExperimentOptions options = OffsetsAlone();
  options.truth.upper_elasticity_scale = 1.0;
  const Comparison of = Compare(project, {drawn.postures[0], drawn.postures[1]}, options);
  EXPECT_EQ(of.recording.postures.size(), 4u);
  for (const Eigen::VectorXd& left : of.left) {
    // Contacts and arms give way by millimetres. Offsets of a degree would be 10 mm and 20 mrad.
    EXPECT_NEAR(left[0], 0.0, 4e-3);
    EXPECT_LT(left.tail<2>().cwiseAbs().maxCoeff(), 6e-3);
  }
}

/// The plate's face in each sample, relative to the floor under the foot that the planner does not
/// use.
std::vector<Transform> FacesOf(const Project& project, int plate, const Eigen::MatrixXd& q) {
  const ObservationSetup setup = ObservedPostureSampler(project, 0).setup();
  const PhysicalPlate face = DescribedPlate(setup.plates[Size(plate)]);
  const ContactFoot& right = setup.feet[1];
  std::vector<Transform> faces;
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    const std::vector<Transform> links = LinkTransforms(project.tree, q.row(i).transpose());
    faces.push_back(right.T_floor_foot * links[Size(right.link)].inverse() *
                    links[Size(face.link)] * face.T_link_face);
  }
  return faces;
}

TEST(PlanTouches, PlatesComeStraightDownOntoTheirTablesAndAreNeverInThem) {
  const Project project = TouchProject();
  const ObservationDesign drawn = DrawObservedPostures(project, 2, 5);
  const MotionPlan plan = PlanMotion(project, drawn.postures, {});
  EXPECT_TRUE(plan.left_out.empty()) << plan.left_out[0];
  EXPECT_TRUE(plan.broken().empty()) << plan.broken()[0].Describe();
  ASSERT_EQ(plan.planned.size(), 3u);
  for (int plate = 0; plate < 2; ++plate) {
    const PlannedTour& tour = plan.planned[Size(plate)];
    const TableTop& table = *project.contact->tables[Size(plate)];
    const std::vector<Transform> faces = FacesOf(project, plate, tour.motion.q);
    const auto height = [&](int i) { return faces[Size(i)].translation().z() - table.centre.z(); };
    ASSERT_EQ(tour.visits.size(), 2u);
    for (const Visit& visit : tour.visits) {
      const Transform& touch = faces[Size(visit.begin)];
      EXPECT_NEAR(height(visit.begin), 0.0, 1e-7);
      EXPECT_LT((touch.linear().col(2) - Eigen::Vector3d::UnitZ()).norm(), 1e-7);
      EXPECT_NEAR(height(visit.begin - 300), 0.05, 1e-4) << "3 s before, at 100 Hz";
      for (int i = visit.begin - 300; i < visit.end; ++i) {
        // The root link moves a little to keep the balance.
        EXPECT_LT((faces[Size(i)].translation() - touch.translation()).head<2>().norm(), 2e-3);
        EXPECT_LT((faces[Size(i)].linear() - touch.linear()).norm(), 1e-6);
      }
    }
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const Eigen::Vector2d off = (faces[i].translation() - table.centre).head<2>();
      const bool over = (off.cwiseAbs() - 0.5 * table.size).maxCoeff() < 0.0;
      EXPECT_TRUE(!over || height(static_cast<int>(i)) > -1e-7);
    }
  }
}

// When the first foot is in the air, the second one places the robot.
TEST(PlanTouches, TheRootIsPlacedByTheFootThatStands) {
  const Project project = TouchProject();
  const ObservedPostureSampler stance(project, 0);
  const StandingRobot& robot = stance.robot();
  for (const int swings : {0, 1}) {
    PlacedPosture pose{robot.rest, robot.T_world_root};
    const Transform T_lifted =
        Eigen::Translation3d(0.0, 0.0, 0.05) * robot.T_world_sole[Size(swings)];
    ASSERT_TRUE(PlaceSole(robot, swings, T_lifted, pose));
    EXPECT_TRUE(RootOnFloor(robot, pose.q).isApprox(robot.T_world_root, 1e-9)) << swings;
    EXPECT_FALSE(RootOverFeet(robot, {swings}, pose.q).isApprox(robot.T_world_root, 1e-3));
  }
}

TEST(PlanTouches, ATableInTheWayAndAHandThatDoesNotReachAreNamed) {
  Project project = TouchProject();
  const ObservationDesign drawn = DrawObservedPostures(project, 1, 5);
  MotionPlanOptions high;
  high.approach.height = 0.7;
  const MotionPlan without_reach = PlanMotion(project, {drawn.postures[0]}, high);
  ASSERT_EQ(without_reach.left_out.size(), 1u);
  EXPECT_NE(without_reach.left_out[0].find("reach of the hand above the table"), std::string::npos)
      << without_reach.left_out[0];
  EXPECT_EQ(without_reach.impossible, std::vector<std::string>{"left"});
  project.contact->tables[0]->centre.z() += 0.02;
  const MotionPlan inside = PlanMotion(project, {drawn.postures[0]}, {});
  ASSERT_EQ(inside.left_out.size(), 1u);
  EXPECT_NE(inside.left_out[0].find("the table of left (limit: touch) -16.0 mm"), std::string::npos)
      << inside.left_out[0];
}

// The tilt of the root link is a quantity that the project does not name.
TEST(DesignObservations, ARootLinkThatIsHeldNeedsNoFeet) {
  ScratchFolder folder;
  std::ofstream(folder.path() / "project.yaml")
      << "robot: {urdf: " << SourceFile("tests/robots/arm6.urdf").string() << "}\n"
      << "instruments:\n"
         "  trackers: [{name: laser}]\n"
         "  poses: [{name: tool, link: tool, tracker: laser}]\n"
         "recording: {not_recorded_mm: {finger_left_joint: 10}}\n";
  const Project project = ReadProject(folder.path() / "project.yaml");
  const ObservationDesign design = DesignObservations(project, {.count = 6, .candidates = 2});
  ASSERT_TRUE(design.infeasible.empty()) << design.infeasible;
  std::size_t count = 0;
  for (const ChainPostures& of : design.postures) count += of.q.size();
  EXPECT_EQ(count, 6u);
}

class DesignForArm : public ArmWithTracker {};

// The design's prediction of a change is what a check with these postures finds.
TEST_F(DesignForArm, SaysHowWellACheckWillTellAChange) {
  const std::filesystem::path calibration = WriteCalibration();
  const ObservationDesign design = DesignObservations(project_, {.count = 6,
                                                                 .candidates = 10,
                                                                 .after = calibration,
                                                                 .changes = true,
                                                                 .joints = {"elbow_joint"}});
  ASSERT_TRUE(design.infeasible.empty()) << design.infeasible;
  ASSERT_EQ(design.zeros.size(), 1u);
  EXPECT_EQ(design.zeros[0].joint, "elbow_joint");
  q_.topRows(6) = Eigen::MatrixXd::Zero(6, q_.cols());
  int row = 0;
  for (const ChainPostures& of : design.postures) {
    for (const Eigen::VectorXd& q : of.q) q_.row(row++) = q.transpose();
  }
  ASSERT_EQ(row, 6);
  Change("elbow_joint.theta", 0.01);
  const ContactCheck check =
      CheckContacts(project_, calibration, {Table(q_.topRows(6), "today.csv")});
  ASSERT_EQ(check.check.moved.size(), 1u) << CheckStatus(check);
  EXPECT_EQ(check.check.moved[0].joint, "elbow_joint");
  ASSERT_TRUE(check.check.moved[0].zero_alone);
  EXPECT_NEAR(check.check.moved[0].changes[0].sd / design.zeros[0].sd, 1.0, 0.3);

  const ObservationDesign all =
      DesignObservations(project_, {.count = 6, .candidates = 10, .after = calibration});
  EXPECT_GT(all.zeros.size(), 4u);
  ExpectInputError(
      [&] {
        DesignObservations(project_,
                           {.count = 6, .after = calibration, .changes = true, .joints = {"knee"}});
      },
      {"'knee'", "elbow_joint"});
}

TEST(DesignObservations, ChosenPosturesTellMoreThanRandomOnes) {
  const Project project = TouchProject();
  const ObservationDesign design = DesignObservations(project, {.count = 10, .candidates = 3});
  ASSERT_TRUE(design.infeasible.empty()) << design.infeasible;
  std::size_t count = 0;
  for (const ChainPostures& of : design.postures) {
    count += of.q.size();
    for (const Eigen::VectorXd& q : of.q) {
      EXPECT_TRUE(((q - project.motion.lower).array() >= 0.0).all());
      EXPECT_TRUE(((project.motion.upper - q).array() >= 0.0).all());
    }
  }
  EXPECT_EQ(count, 10u);
  EXPECT_EQ(design.candidates, 30);
  EXPECT_GT(design.information, 1.05 * design.information_at_random);
}

}  // namespace
}  // namespace elastocal
