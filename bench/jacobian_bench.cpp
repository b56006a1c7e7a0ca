// SPDX-License-Identifier: Apache-2.0
// Compares the generalized Jacobian (eq. 4) with central differences and with MuJoCo. Times are
// seconds per posture, and both of a pair are measured in turns in one run.
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "bench/compare.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/robot/jacobian.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "tests/mujoco_oracle.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

constexpr int kPostures = 50;

std::vector<Eigen::VectorXd> RandomPostures(const RobotTree& tree) {
  Random random(1);
  std::vector<Eigen::VectorXd> postures;
  for (int i = 0; i < kPostures; ++i) postures.push_back(RandomPosture(tree, random));
  return postures;
}

Project Talos() { return ReadProject(SourceFile("models/talos/project.yaml")); }

ErrorModel WholeBody(const Project& project) {
  return MakeErrorModel(project.tree, project.markers, project.placement);
}

/// The left leg, with 6 joints and 9 markers.
ErrorModel Leg(const Project& project) {
  for (const Chain& chain : project.chains) {
    if (chain.name != "leg_left") continue;
    return SelectMarkers(WholeBody(project), ChainMarkers(project, chain));
  }
  throw std::runtime_error("models/talos/project.yaml has no chain leg_left");
}

Eigen::VectorXd NominalErrors(const ErrorModel& model) {
  return Eigen::VectorXd::Zero(model.parameter_count());
}

void EvaluateAll(GeneralizedJacobian& jacobian, const Geometry& geometry,
                 const std::vector<Eigen::VectorXd>& postures) {
  for (const Eigen::VectorXd& q : postures) {
    jacobian.Evaluate(geometry, q);
    benchmark::DoNotOptimize(jacobian.Block(0).data());
  }
}

/// Central differences of the same positions with respect to every parameter: two evaluations for
/// each column. The changed geometry is made once for each column and serves all postures, as for
/// the analytic Jacobian.
void CentralDifferences(const ErrorModel& model, const std::vector<Eigen::VectorXd>& postures) {
  constexpr double kStep = 1e-6;
  Eigen::VectorXd delta = NominalErrors(model);
  std::vector<Eigen::MatrixXd> jacobians(
      postures.size(), Eigen::MatrixXd(3 * model.marker_count(), model.parameter_count()));
  for (int k = 0; k < model.parameter_count(); ++k) {
    delta[k] = kStep;
    const Geometry forward = ApplyErrors(model, delta);
    delta[k] = -kStep;
    const Geometry backward = ApplyErrors(model, delta);
    delta[k] = 0.0;
    for (std::size_t i = 0; i < postures.size(); ++i) {
      jacobians[i].col(k) = ((MarkerPositions(model, forward, postures[i]) -
                              MarkerPositions(model, backward, postures[i])) /
                             (2.0 * kStep))
                                .reshaped();
    }
  }
  benchmark::DoNotOptimize(jacobians.data());
}

using Differences = std::function<void(const ErrorModel&, const std::vector<Eigen::VectorXd>&)>;

void CompareLeg(benchmark::State& state, const Differences& differences) {
  const ErrorModel model = Leg(Talos());
  const std::vector<Eigen::VectorXd> postures = RandomPostures(model.tree);
  const Geometry geometry = ApplyErrors(model, NominalErrors(model));
  GeneralizedJacobian jacobian(model);
  CompareInTurns(
      state, kPostures, [&] { EvaluateAll(jacobian, geometry, postures); },
      [&] { differences(model, postures); });
}

void LegAgainstCentralDifferencesOfOnePosture(benchmark::State& state) {
  CompareLeg(state, [](const ErrorModel& model, const std::vector<Eigen::VectorXd>& postures) {
    for (const Eigen::VectorXd& q : postures) CentralDifferences(model, {q});
  });
}
BENCHMARK(LegAgainstCentralDifferencesOfOnePosture);

void LegAgainstCentralDifferencesOfManyPostures(benchmark::State& state) {
  CompareLeg(state, CentralDifferences);
}
BENCHMARK(LegAgainstCentralDifferencesOfManyPostures);

/// MuJoCo's point Jacobians: kinematics as mj_jac needs them, then a call for each marker. They
/// have only the columns of joint positions, while ours have all columns.
class MujocoJacobians {
 public:
  MujocoJacobians(const Project& project, const std::vector<Eigen::VectorXd>& postures)
      : mujoco_(project.urdf, project.tree.links[0].name) {
    for (const Marker& marker : project.markers) {
      bodies_.push_back(mujoco_.LinkId(project.tree.links[marker.link].name));
    }
    const ErrorModel model = WholeBody(project);
    const Geometry geometry = ApplyErrors(model, NominalErrors(model));
    for (const Eigen::VectorXd& q : postures) {
      for (const Joint& joint : project.tree.joints) {
        mujoco_.SetPosition(joint.name, JointPosition(joint, q));
      }
      qpos_.emplace_back(Eigen::VectorXd::Map(mujoco_.data()->qpos, mujoco_.model()->nq));
      points_.push_back(MarkerPositions(model, geometry, q));
    }
    jacobian_.resize(3 * mujoco_.model()->nv);
  }

  void EvaluateAll() {
    const mjModel* model = mujoco_.model();
    mjData* data = mujoco_.data();
    for (std::size_t i = 0; i < qpos_.size(); ++i) {
      Eigen::VectorXd::Map(data->qpos, model->nq) = qpos_[i];
      mj_kinematics(model, data);
      mj_comPos(model, data);
      for (std::size_t m = 0; m < bodies_.size(); ++m) {
        mj_jac(model, data, jacobian_.data(), nullptr,
               points_[i].col(static_cast<Eigen::Index>(m)).data(), bodies_[m]);
        benchmark::DoNotOptimize(jacobian_.data());
      }
    }
  }

 private:
  MujocoOracle mujoco_;
  std::vector<int> bodies_;               // for each marker
  std::vector<Eigen::VectorXd> qpos_;     // for each posture
  std::vector<Eigen::Matrix3Xd> points_;  // for each posture
  Eigen::VectorXd jacobian_;
};

void WholeBodyAgainstMujoco(benchmark::State& state) {
  const Project project = Talos();
  const ErrorModel model = WholeBody(project);
  const std::vector<Eigen::VectorXd> postures = RandomPostures(model.tree);
  const Geometry geometry = ApplyErrors(model, NominalErrors(model));
  GeneralizedJacobian jacobian(model);
  MujocoJacobians mujoco(project, postures);
  CompareInTurns(
      state, kPostures, [&] { EvaluateAll(jacobian, geometry, postures); },
      [&] { mujoco.EvaluateAll(); });
}
BENCHMARK(WholeBodyAgainstMujoco);

}  // namespace
}  // namespace elastocal
