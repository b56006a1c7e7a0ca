#include <algorithm>

#include <gtest/gtest.h>

#include "elastocal/contact/contact_fit.hpp"
#include "tests/touching_biped.hpp"

namespace elastocal {
namespace {

/// Three touches of the invented robot with random errors, away from flush.
struct RandomTouches {
  ContactModel model = MakeTouchingBiped();
  Touches touches;
  ContactValues values;
  ContactSpread spread;
  std::vector<double> weights = {1.0, 0.5, 0.0};

  explicit RandomTouches(std::uint64_t seed) {
    Random random(seed);
    touches.files = {"f"};
    touches.sessions = {{0, "a"}, {1, "b"}, {0, "c"}};
    touches.touches = {{0, 0, 0, 2}, {1, 1, 0, 3}, {0, 2, 0, 4}};
    touches.q.resize(3, model.robot.tree.coordinate_count());
    for (int i = 0; i < 3; ++i) touches.q.row(i) = TouchingPosture(model, random);
    values = NominalContacts(model, touches);
    const ContactValues errors = RandomTruth(model, spread, 2, random);
    values.robot = errors.robot;
    for (std::size_t p = 0; p < 2; ++p) {
      values.plate_tilts[p] = errors.plate_tilts[p];
      values.tables[p].height_tilts = errors.tables[p].height_tilts;
    }
    for (std::size_t s = 0; s < 3; ++s) values.sessions[s] = errors.sessions[s];
  }
};

TEST(ContactResiduals, DerivativesAgreeWithDifferences) {
  for (std::uint64_t seed : {1u, 2u, 3u}) {
    const RandomTouches at(seed);
    // Loads are constants of the problem, and bend the robot.
    const std::vector<JointLoads> loads = ContactLoads(at.model, at.touches, at.values.robot);
    ContactResiduals residuals(at.model, at.touches, loads, at.spread, at.weights, {}, at.values);
    const Eigen::VectorXd x = residuals.Start();
    residuals.Evaluate(x, true);
    std::vector<LeastSquaresProblem::RowMajorMatrix> jacobians;
    for (std::size_t b = 0; b < residuals.residual_blocks.size(); ++b) {
      jacobians.push_back(residuals.Jacobian(static_cast<int>(b)));
    }
    std::vector<Eigen::Index> first = {0};
    for (int size : residuals.parameter_blocks) first.push_back(first.back() + size);
    // Of numbers about 1 to 100: the step's square leaves 1e-8, roundings 1e-9.
    const double step = 1e-4;
    for (std::size_t b = 0; b < residuals.residual_blocks.size(); ++b) {
      Eigen::Index column = 0;
      for (int block : residuals.residual_blocks[b].parameter_blocks) {
        for (Eigen::Index i = first[block]; i < first[block + 1]; ++i, ++column) {
          Eigen::VectorXd forward = x;
          Eigen::VectorXd backward = x;
          forward[i] += step;
          backward[i] -= step;
          residuals.Evaluate(forward, false);
          Eigen::VectorXd difference = residuals.Residual(static_cast<int>(b));
          residuals.Evaluate(backward, false);
          difference -= residuals.Residual(static_cast<int>(b));
          difference /= 2.0 * step;
          const Eigen::VectorXd own = jacobians[b].col(column);
          EXPECT_LT((own - difference).norm(), 1e-7 * (1.0 + own.norm()))
              << "seed " << seed << ", block " << b << ", unknown " << i;
        }
      }
      EXPECT_EQ(column, jacobians[b].cols());
    }
  }
}

TEST(ContactResiduals, AreThoseOfTheNominalRobotByHand) {
  const RandomTouches at(4);
  ContactValues nominal = NominalContacts(at.model, at.touches);
  const Eigen::MatrixX3d left = LeftOfTouches(at.model, at.touches, nominal);
  // By links of the URDF: with equal feet the root stands in the middle of both.
  const ContactSetup& setup = at.model.setup;
  const std::vector<Transform> T =
      LinkTransforms(at.model.robot.tree, Eigen::VectorXd(at.touches.q.row(1)));
  Eigen::Vector3d height = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation[2];
  for (std::size_t f = 0; f < 2; ++f) {
    const Transform root = setup.feet[f].T_floor_foot * T[setup.feet[f].link].inverse();
    height += 0.5 * root.translation();
    rotation[f] = Eigen::Quaterniond(root.linear());
  }
  Transform root = Transform::Identity();
  root.linear() = rotation[0].slerp(0.5, rotation[1]).toRotationMatrix();
  root.translation() = height;
  const Transform hand = root * T[setup.plates[1].link];
  EXPECT_NEAR(left(1, 0), (hand * setup.plates[1].face.p_link_face - nominal.tables[1].pivot).z(),
              1e-12);
  const Eigen::Vector3d up = (hand.linear() * setup.plates[1].face.R_link_face).transpose().col(2);
  EXPECT_NEAR(left(1, 1), std::atan2(up.y(), up.z()), 1e-12);
  EXPECT_NEAR(left(1, 2), -std::asin(up.x()), 1e-12);
}

TEST(ContactResiduals, ParametersInCommonHaveOneUnknown) {
  const ContactModel model = MakeTouchingBiped();
  const auto unknown = [&](const char* name) {
    return model.unknown[FindParameter(model.robot.parameters, name)];
  };
  EXPECT_EQ(unknown("left_3.compliance_z"), unknown("right_3.compliance_z"));
  EXPECT_NE(unknown("left_3.theta"), unknown("right_3.theta"));
  EXPECT_EQ(unknown("waist.T0.r"), -1);
  Touches left_only;
  left_only.touches = {{0, 0, 0, 0}};
  ContactModel reduced = model;
  KeepTouchedUnknowns(left_only, reduced);
  EXPECT_EQ(reduced.unknown[FindParameter(model.robot.parameters, "arm_right_2.theta")], -1);
  EXPECT_GE(reduced.unknown[FindParameter(model.robot.parameters, "arm_left_2.theta")], 0);
  EXPECT_EQ(reduced.unknown_count,
            *std::max_element(reduced.unknown.begin(), reduced.unknown.end()) + 1);
}

}  // namespace
}  // namespace elastocal
