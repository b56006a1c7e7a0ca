// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/posture_problem.hpp"

#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "elastocal/math/decompositions.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/posture/random_posture.hpp"
#include "elastocal/robot/leg_load.hpp"
#include "tests/leg_problem.hpp"
#include "tests/random_robot.hpp"

namespace elastocal {
namespace {

constexpr double kStep = 1e-6;

std::vector<int> AllParameters(const ErrorModel& model) {
  std::vector<int> all(static_cast<std::size_t>(model.parameter_count()));
  for (int i = 0; i < model.parameter_count(); ++i) all[static_cast<std::size_t>(i)] = i;
  return all;
}

/// Compares the gradient of sum(weight .* Psi) with differences for random robots and weights.
void ExpectGradient(const ErrorModel& model, const MovingChain& moving, Random& random,
                    double tolerance, RootPose root = RootPose::kConstant,
                    const Eigen::VectorXd& shown = {}) {
  MovingChain chain = moving;
  PostureRegressor regressor(model, AllParameters(model), chain, root);
  const Eigen::VectorXd x = RandomPosture(model.tree, random)(chain.coordinates());
  Eigen::MatrixXd weight(regressor.rows(), regressor.columns());
  for (Eigen::Index i = 0; i < weight.size(); ++i) weight.data()[i] = random.Normal(1.0);
  regressor.Evaluate(chain, x, shown);
  const Eigen::VectorXd gradient = regressor.Gradient(chain, weight);
  for (int i = 0; i < chain.size(); ++i) {
    const Eigen::MatrixXd ahead =
        regressor.Evaluate(chain, x + kStep * Eigen::VectorXd::Unit(chain.size(), i), shown);
    const Eigen::MatrixXd behind =
        regressor.Evaluate(chain, x - kStep * Eigen::VectorXd::Unit(chain.size(), i), shown);
    EXPECT_NEAR(gradient[i], weight.cwiseProduct(ahead - behind).sum() / (2 * kStep), tolerance);
  }
}

TEST(PostureRegressor, GradientEqualsDifferencesOnRandomRobots) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    RobotTree tree = RandomRobot(kUsualRelations, random);
    AddJoint(tree, "follower", static_cast<int>(tree.links.size()) - 1, Offset(0.1, 0.2, -0.1),
             {0.3, 0.5, 0.8});
    MakeLastJointMimic(tree, 0, -0.7, 0.2);
    const ErrorModel model = MakeErrorModel(tree, RandomMarkers(tree, random));
    const MovingChain chain(model.tree,
                            ChainCoordinates(tree, 0, static_cast<int>(tree.links.size()) - 1),
                            RandomPosture(tree, random));
    // Some hundred terms of order one, whose differences have errors of 1e-9 each.
    ExpectGradient(model, chain, random, 1e-6);
  }
}

TEST(PostureRegressor, GradientOfCompliancesEqualsDifferences) {
  Elasticity elasticity;
  elasticity.torsion = {0, 1, 2, 3};
  elasticity.bending = {1, 2, 3};
  LegProblem leg(Criterion::kO1, elasticity);
  Random random(5);
  // The columns are multiplied by loads of up to 100 N.m.
  ExpectGradient(leg.model, leg.problem.feasible.chain, random, 1e-4);
}

TEST(PostureRegressor, GradientWithAFreeRootEqualsDifferences) {
  Elasticity elasticity;
  elasticity.torsion = {1, 2, 3};
  LegProblem leg(Criterion::kO1, elasticity);
  const MovingChain& chain = leg.problem.feasible.chain;
  Random random(6);
  ExpectGradient(leg.model, chain, random, 1e-4, RootPose::kFree);
  Eigen::VectorXd shown = Eigen::VectorXd::Ones(3 * leg.model.marker_count());
  shown.segment<3>(3).setZero();
  ExpectGradient(leg.model, chain, random, 1e-4, RootPose::kFree, shown);
  shown.setZero();  // two markers do not show the turn about their line
  shown.head<3>().setOnes();
  shown.tail<3>().setOnes();
  ExpectGradient(leg.model, chain, random, 1e-4, RootPose::kFree, shown);
}

// With a free root, a posture spends six numbers on the robot's pose. What remains for the
// parameters is the Schur complement of the information of all unknowns.
TEST(PostureRegressor, WithAFreeRootTheInformationIsTheSchurComplement) {
  LegProblem leg;
  MovingChain chain = leg.problem.feasible.chain;
  const Eigen::VectorXd x = Eigen::Vector4d(0.1, 0.2, -0.4, 0.9);
  Eigen::VectorXd shown = Eigen::VectorXd::Ones(3 * leg.model.marker_count());
  shown.segment<3>(6).setZero();
  const std::vector<int> all = AllParameters(leg.model);
  const Eigen::MatrixXd psi = PostureRegressor(leg.model, all, chain).Evaluate(chain, x, shown);
  const Eigen::MatrixXd free =
      PostureRegressor(leg.model, all, chain, RootPose::kFree).Evaluate(chain, x, shown);
  const Eigen::MatrixXd A = psi.transpose() * psi;
  const Eigen::MatrixXd spent =
      A.leftCols<6>() * A.topLeftCorner<6, 6>().inverse() * A.topRows<6>();
  EXPECT_LT((free.transpose() * free - (A - spent)).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_LT(free.leftCols<6>().cwiseAbs().maxCoeff(), 1e-12);
}

TEST(PostureRegressor, IsTheGeneralizedJacobianUnderGravity) {
  Elasticity elasticity;
  elasticity.torsion = {2, 3};
  LegProblem leg(Criterion::kO1, elasticity);
  MovingChain chain = leg.problem.feasible.chain;
  PostureRegressor regressor(leg.model, AllParameters(leg.model), chain);
  const Eigen::VectorXd x = Eigen::Vector4d(0.1, 0.2, -0.4, 0.9);
  const Geometry geometry =
      ApplyErrors(leg.model, Eigen::VectorXd::Zero(leg.model.parameter_count()));
  GeneralizedJacobian jacobian(leg.model);
  jacobian.Evaluate(geometry, x, GravityLoads(leg.model, geometry, x, kGravity, 0));
  EXPECT_LT((regressor.Evaluate(chain, x) - jacobian.Dense()).cwiseAbs().maxCoeff(), 1e-12);
}

/// The leg's robot, which stands on another leg. Its chain is seen relative to the waist.
struct StandingLegProblem {
  StandingLegProblem() {
    RobotTree tree = MakeLegRobot();
    int link = AddJoint(tree, "other_hip", 0, Offset(0.0, -0.1, -0.1), {0.3, 0.5, 0.8});
    link = AddJoint(tree, "other_knee", link, Offset(0, 0, -0.4), {0, 1, 0});
    const int foot = AddFixedLink(tree, "other_foot", link, Offset(0.02, 0.0, -0.4));
    Elasticity elasticity;
    elasticity.torsion = {2, 3};
    elasticity.legs = {{"other", foot}};
    model = MakeErrorModel(tree, LegMarkers(tree), {}, elasticity);
    rest.setZero(tree.coordinate_count());
    rest[4] = 0.2;
    rest[5] = 0.4;
  }
  ErrorModel model;
  Eigen::VectorXd rest;
};

TEST(PostureRegressor, GradientOfAStandingLegsCompliancesEqualsDifferences) {
  const StandingLegProblem leg;
  Random random(8);
  // The columns are multiplied by weights of 100 N.
  ExpectGradient(leg.model, MovingChain(leg.model.tree, {0, 1, 2, 3}, leg.rest), random, 1e-3);
}

TEST(PostureRegressor, AStandingLegMovesTheMarkersAsItsWaistGivesWay) {
  const StandingLegProblem leg;
  MovingChain chain(leg.model.tree, {0, 1, 2, 3}, leg.rest);
  PostureRegressor regressor(leg.model, AllParameters(leg.model), chain);
  const Eigen::VectorXd x = Eigen::Vector4d(0.1, 0.2, -0.4, 0.9);
  const Eigen::MatrixXd psi = regressor.Evaluate(chain, x);
  const Geometry geometry =
      ApplyErrors(leg.model, Eigen::VectorXd::Zero(leg.model.parameter_count()));
  const LegPosture posture = PlaceLeg(leg.model, geometry, chain.FullPosture(x), 0);
  const Vector6d load = LoadFromStatics(leg.model, posture, kGravity);
  const Transform T_ref_foot = leg.model.T_ref_waist * posture.T_foot_waist.inverse();
  const char* const names[] = {"other.compliance_x",  "other.compliance_y",  "other.compliance_z",
                               "other.compliance_rx", "other.compliance_ry", "other.compliance_rz"};
  for (int entry = 0; entry < 6; ++entry) {
    constexpr double kSmall = 1e-8;  // m/N or rad/(N.m)
    const WaistDeflection given =
        DeflectWaist(posture.T_foot_waist, kSmall * Vector6d::Unit(entry), load);
    const Transform moved =
        T_ref_foot * given.T_foot_waist * (T_ref_foot * posture.T_foot_waist).inverse();
    const int column = FindParameter(leg.model.parameters, names[entry]);
    for (int m = 0; m < leg.model.marker_count(); ++m) {
      const Marker& marker = leg.model.markers[static_cast<std::size_t>(m)];
      const Eigen::Vector3d p =
          leg.model.T_ref_waist *
          (LinkTransforms(leg.model.tree,
                          chain.FullPosture(x))[static_cast<std::size_t>(marker.link)] *
           marker.p_link_marker);
      const Eigen::Vector3d expected = (moved * p - p) / kSmall;
      EXPECT_LT((psi.block<3, 1>(3 * m, column) - expected).norm(), 1e-3) << names[entry];
    }
  }
}

TEST(PostureRegressor, RefusesTheComplianceOfALegThatMoves) {
  Elasticity elasticity;
  elasticity.legs = {{"leg", FindLink(MakeLegRobot(), "foot")}};
  const ErrorModel model =
      MakeErrorModel(MakeLegRobot(), LegMarkers(MakeLegRobot()), {}, elasticity);
  const MovingChain chain(model.tree, {0, 1, 2, 3}, Eigen::VectorXd::Zero(4));
  EXPECT_THROW(PostureRegressor(model, AllParameters(model), chain), std::invalid_argument);
}

class EachCriterion : public testing::TestWithParam<Criterion> {};

TEST_P(EachCriterion, WeightGivesTheGradientOfTheIndex) {
  LegProblem leg(GetParam());
  PostureProblem& problem = leg.problem;
  FeasibleSampler sampler(problem.feasible, 11);
  PostureSet set(problem.column_count());
  for (int i = 0; i < 5; ++i) set.Add(problem, *sampler.Draw());
  const CriterionValue value = EvaluateCriterion(GetParam(), set.information(), set.size());
  ASSERT_TRUE(value.defined());
  const Eigen::VectorXd x = set.posture(2);
  const Eigen::MatrixXd weight =
      problem.regressor.Evaluate(problem.feasible.chain, x) * value.weight;
  const Eigen::VectorXd gradient = problem.regressor.Gradient(problem.feasible.chain, weight);
  for (int i = 0; i < 4; ++i) {
    double log_index[2];
    for (int side : {0, 1}) {
      PostureSet moved = set;
      moved.Replace(problem, 2, x + (side == 0 ? -kStep : kStep) * Eigen::VectorXd::Unit(4, i));
      log_index[side] = EvaluateCriterion(GetParam(), moved.information(), moved.size()).log_index;
    }
    // Smallest eigenvalues are differences of large ones, so six digits remain.
    EXPECT_NEAR(gradient[i], (log_index[1] - log_index[0]) / (2 * kStep), 1e-5);
  }
}

INSTANTIATE_TEST_SUITE_P(All, EachCriterion,
                         testing::Values(Criterion::kO1, Criterion::kO2, Criterion::kO3,
                                         Criterion::kO4, Criterion::kO5));

TEST(PostureSet, O1IsTheRootOfTheProductOfSingularValues) {
  LegProblem leg;
  FeasibleSampler sampler(leg.problem.feasible, 2);
  PostureSet set(leg.problem.column_count());
  for (int i = 0; i < 6; ++i) set.Add(leg.problem, *sampler.Draw());
  Eigen::MatrixXd stacked(6 * leg.problem.regressor.rows(), set.information().cols());
  for (int i = 0; i < 6; ++i) {
    stacked.middleRows(i * leg.problem.regressor.rows(), leg.problem.regressor.rows()) = set.psi(i);
  }
  const Eigen::VectorXd sigma = SingularValues(stacked);
  const double o1 = std::exp(sigma.array().log().mean()) / std::sqrt(6.0);
  EXPECT_NEAR(set.Index(Criterion::kO1), o1, 1e-10 * o1);
}

TEST(PostureSet, IndicesWithoutEachAreThoseOfTheSmallerSets) {
  LegProblem leg;
  FeasibleSampler sampler(leg.problem.feasible, 4);
  PostureSet set(leg.problem.column_count());
  for (int i = 0; i < 6; ++i) set.Add(leg.problem, *sampler.Draw());
  const Eigen::VectorXd without = IndicesWithoutEach(set, Criterion::kO1);
  for (int k = 0; k < 6; ++k) {
    PostureSet smaller = set;
    smaller.Remove(k);
    EXPECT_NEAR(without[k], smaller.Index(Criterion::kO1), 1e-9 * without[k]);
  }
}

TEST(PostureSet, OnePostureDoesNotDetermineAll) {
  LegProblem leg;
  const PostureSet set = MakePostureSet(leg.problem, {leg.motion.rest});
  EXPECT_EQ(set.Index(Criterion::kO1), 0.0);
}

TEST(MarkerVisibility, HidesWhatIsBehindASphere) {
  const ErrorModel model = MakeErrorModel(MakeLegRobot(), LegMarkers(MakeLegRobot()));
  MotionSetup motion = LegMotion(model.tree);
  // A sphere of the pelvis hides the markers from a camera far on the right.
  motion.spheres = {{"WALL", 0, {0.0, -1.5, -0.5}, 1.0}};
  motion.cameras = {{0.0, -5.0, -0.5}};
  const ChainSetup setup = [&] {
    ChainSetup s = LegSetup(model.tree);
    s.contacts.clear();
    return s;
  }();
  const BaseParameters base = FindChainParameters(model, motion, setup, {});
  PostureProblem hidden = MakeChainProblem(model, base.kept, motion, setup);
  ASSERT_TRUE(hidden.visible);
  EXPECT_TRUE(EvaluateRegressor(hidden, motion.rest).isZero(0.0));
  motion.cameras.emplace_back(0.0, 5.0, -0.5);  // from the other side, all markers are seen
  EXPECT_EQ((EvaluateRegressor(hidden, motion.rest).rowwise().norm().array() > 0.0).count(), 18);
}

}  // namespace
}  // namespace elastocal
