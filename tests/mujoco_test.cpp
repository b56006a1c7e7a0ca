// SPDX-License-Identifier: Apache-2.0
// Compares kinematics, Jacobian and statics of the robot layer with MuJoCo, an independent
// implementation.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/robot/inverse_dynamics.hpp"
#include "elastocal/robot/jacobian.hpp"
#include "elastocal/robot/robot_tree.hpp"
#include "elastocal/robot/statics.hpp"
#include "tests/mujoco_oracle.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

class AgainstMujoco : public testing::TestWithParam<const char*> {
 protected:
  AgainstMujoco()
      : file_(SourceFile(GetParam())),
        tree_(ReadUrdf(file_)),
        mujoco_(file_, tree_.links[0].name) {}

  /// Sets both models to a random posture.
  Eigen::VectorXd NextPosture() {
    const Eigen::VectorXd q = RandomPosture(tree_, random_);
    for (const Joint& joint : tree_.joints) {
      mujoco_.SetPosition(joint.name, JointPosition(joint, q));
    }
    return q;
  }

  /// MuJoCo's torques by coordinate. A mimic joint's torque counts with its multiplier (chain
  /// rule).
  Eigen::VectorXd MujocoTorques() const {
    Eigen::VectorXd torques = Eigen::VectorXd::Zero(tree_.coordinate_count());
    for (const Joint& joint : tree_.joints) {
      torques[joint.coordinate] += joint.multiplier * mujoco_.GravityTorque(joint.name);
    }
    return torques;
  }

  std::filesystem::path file_;
  RobotTree tree_;
  MujocoOracle mujoco_;
  Random random_{1};
};

constexpr int kPostures = 100;

TEST_P(AgainstMujoco, LinkPoses) {
  // Both use double precision for a robot of a metre or two. Rounding is about 1e-15, so that 1e-9
  // m and rad leave no room for a different model.
  for (int i = 0; i < kPostures; ++i) {
    const std::vector<Transform> T_root_link = LinkTransforms(tree_, NextPosture());
    mujoco_.Update();
    for (std::size_t k = 0; k < tree_.links.size(); ++k) {
      const Transform expected = mujoco_.LinkPose(tree_.links[k].name);
      EXPECT_LT((T_root_link[k].translation() - expected.translation()).norm(), 1e-9)
          << tree_.links[k].name;
      EXPECT_LT(RotationAngle(T_root_link[k].linear().transpose() * expected.linear()), 1e-9)
          << tree_.links[k].name;
    }
  }
}

TEST_P(AgainstMujoco, JacobianOfJointPositions) {
  // An error of theta (r if the joint slides) moves a marker like the joint itself. MuJoCo knows
  // only these columns. Each moving link has a marker.
  std::vector<Marker> markers;
  for (std::size_t k = 0; k < tree_.links.size(); ++k) {
    if (tree_.links[k].body == 0) continue;
    markers.push_back({"M_" + tree_.links[k].name, static_cast<int>(k), {0.03, -0.02, 0.05}});
  }
  const ErrorModel model = MakeErrorModel(tree_, markers);
  const Geometry nominal = ApplyErrors(model, Eigen::VectorXd::Zero(model.parameter_count()));
  GeneralizedJacobian jacobian(model);
  for (int i = 0; i < kPostures; ++i) {
    jacobian.Evaluate(nominal, NextPosture());
    mujoco_.Update();
    const Eigen::MatrixXd dense = jacobian.Dense();
    for (const Joint& joint : tree_.joints) {
      const bool slides = joint.type == JointType::kPrismatic;
      const int column = FindParameter(model.parameters, joint.name + (slides ? ".r" : ".theta"));
      for (int m = 0; m < model.marker_count(); ++m) {
        const Eigen::Vector3d expected = mujoco_.PointDerivative(
            joint.name, tree_.links[markers[m].link].name, jacobian.Position(m));
        // Levers are about a metre, and rounding is about 1e-15 m/rad.
        EXPECT_LT((dense.block<3, 1>(3 * m, column) - expected).norm(), 1e-9)
            << joint.name << ", " << markers[m].name;
      }
    }
  }
}

TEST_P(AgainstMujoco, GravityTorques) {
  // Torques reach some 100 N.m, where rounding is about 1e-13.
  for (int i = 0; i < kPostures; ++i) {
    const Eigen::VectorXd torques = GravityTorques(tree_, NextPosture());
    mujoco_.Update();
    EXPECT_LT((torques - MujocoTorques()).lpNorm<Eigen::Infinity>(), 1e-8);
  }
}

TEST_P(AgainstMujoco, GravityTorquesOfALeaningWaist) {
  const Eigen::Vector3d gravity(3.0, -4.0, -8.0);
  mujoco_.SetGravity(gravity);
  for (int i = 0; i < kPostures; ++i) {
    const Eigen::VectorXd torques = GravityTorques(tree_, NextPosture(), gravity);
    mujoco_.Update();
    EXPECT_LT((torques - MujocoTorques()).lpNorm<Eigen::Infinity>(), 1e-8);
  }
}

TEST_P(AgainstMujoco, TorquesOfARobotThatStandsOnOneOfItsLinks) {
  // The tolerance is as above. The robot stands on any link, for instance a foot.
  const Eigen::Vector3d gravity(1.0, -0.5, -9.7);
  mujoco_.SetGravity(gravity);
  for (int i = 0; i < kPostures; ++i) {
    const Eigen::VectorXd q = NextPosture();
    mujoco_.Update();
    const int fixed_link = random_.Index(static_cast<int>(tree_.links.size()));
    Eigen::VectorXd expected = Eigen::VectorXd::Zero(tree_.coordinate_count());
    for (const Joint& joint : tree_.joints) {
      expected[joint.coordinate] +=
          joint.multiplier * mujoco_.StandingTorque(joint.name, tree_.links[fixed_link].name);
    }
    const Eigen::VectorXd torques = StaticTorques(tree_, q, gravity, fixed_link);
    EXPECT_LT((torques - expected).lpNorm<Eigen::Infinity>(), 1e-8) << tree_.links[fixed_link].name;
  }
}

TEST_P(AgainstMujoco, InverseDynamicsOfAFloatingRobot) {
  // With speeds of some rad/s and accelerations of some ten, torques and forces reach some
  // thousand, where rounding is about 1e-12. The inertias are MuJoCo's, which differ from the
  // file's by a millionth.
  RobotTree tree = tree_;
  for (Link& link : tree.links) {
    if (link.mass == 0.0) continue;
    const Eigen::Matrix3d inertia = mujoco_.LinkInertia(link.name);
    EXPECT_LT((inertia - link.inertia).norm(), 1e-5 * link.inertia.norm()) << link.name;
    link.inertia = inertia;
  }
  const std::vector<BodyInertia> inertias = BodyInertias(tree);
  const Eigen::Vector3d gravity(1.0, -0.5, -9.7);
  mujoco_.SetGravity(gravity);
  for (int i = 0; i < kPostures; ++i) {
    RobotState state;
    state.q = RandomPosture(tree_, random_);
    state.velocity = random_.NormalVector(state.q.size(), 2.0);
    state.acceleration = random_.NormalVector(state.q.size(), 10.0);
    state.T_world_root.linear() = RotationFromVector(random_.NormalVector(3, 1.0));
    state.T_world_root.translation() = random_.NormalVector(3, 1.0);
    state.root_velocity = random_.NormalVector(3, 1.0);
    state.root_turn = random_.NormalVector(3, 2.0);
    state.root_acceleration = random_.NormalVector(3, 5.0);
    state.root_turn_rate = random_.NormalVector(3, 10.0);
    mujoco_.SetRootMotion(state.T_world_root, state.root_velocity, state.root_turn,
                          state.root_acceleration, state.root_turn_rate);
    for (const Joint& joint : tree_.joints) {
      mujoco_.SetMotion(joint.name, JointPosition(joint, state.q),
                        joint.multiplier * state.velocity[joint.coordinate],
                        joint.multiplier * state.acceleration[joint.coordinate]);
    }
    mujoco_.UpdateInverse();
    Eigen::VectorXd expected = Eigen::VectorXd::Zero(tree_.coordinate_count());
    for (const Joint& joint : tree_.joints) {
      expected[joint.coordinate] += joint.multiplier * mujoco_.InverseTorque(joint.name);
    }
    const InverseDynamicsResult found = InverseDynamics(tree_, inertias, state, gravity);
    const Eigen::Vector3d origin = state.T_world_root.translation();
    EXPECT_LT((found.torques - expected).lpNorm<Eigen::Infinity>(), 1e-8);
    EXPECT_LT((found.force - mujoco_.InverseForce()).norm(), 1e-8);
    EXPECT_LT((found.moment - origin.cross(found.force) - mujoco_.InverseMoment()).norm(), 1e-8);
  }
}

TEST_P(AgainstMujoco, TotalMass) { EXPECT_NEAR(TotalMass(tree_), mujoco_.TotalMass(), 1e-9); }

INSTANTIATE_TEST_SUITE_P(Robots, AgainstMujoco,
                         testing::Values("models/talos/talos.urdf", "tests/robots/arm6.urdf",
                                         "tests/robots/mini_humanoid.urdf"),
                         [](const auto& robot) {
                           return std::filesystem::path(robot.param).stem().string();
                         });

}  // namespace
}  // namespace elastocal
