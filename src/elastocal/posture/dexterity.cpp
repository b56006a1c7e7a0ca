// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/dexterity.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/math/decompositions.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

constexpr double kArm = 0.3;  // m: length by which displacements are divided
constexpr double kNoMost = 1e3;
constexpr double kLeastSingular = 1e-9;

Eigen::MatrixXd EndJacobian(const MovingChain& chain, int link) {
  Eigen::MatrixXd J(6, chain.size());
  J.topRows<3>() = chain.PointJacobian(link, chain.link_poses()[Size(link)].translation()) / kArm;
  J.bottomRows<3>() = chain.RotationJacobian(link);
  return J;
}

}  // namespace

double LeastSingularValue(const MovingChain& chain, int link) {
  const Eigen::MatrixXd J = EndJacobian(chain, link);
  return std::sqrt(std::max(0.0, SymmetricValues(J * J.transpose())[0]));
}

Dexterity::Dexterity(const MovingChain& chain, int link, double share) : link_(link) {
  SetRange(Eigen::VectorXd::Constant(1, share * LeastSingularValue(chain, link)),
           Eigen::VectorXd::Constant(1, kNoMost));
}

std::string Dexterity::Name(int) const { return "distance of the limb from a singular posture"; }

void Dexterity::Evaluate(const MovingChain& chain, Eigen::Ref<Eigen::VectorXd> value,
                         Eigen::Ref<Eigen::MatrixXd> jacobian) const {
  const Eigen::MatrixXd J = EndJacobian(chain, link_);
  const SymmetricDecomposition squares = DecomposeSymmetric(J * J.transpose());
  value[0] = std::sqrt(std::max(0.0, squares.values[0]));
  // The singular value is u^T J v, and stationary in u and v.
  Eigen::VectorXd u = squares.vectors.col(0);
  const Eigen::VectorXd v = J.transpose() * u / std::max(value[0], kLeastSingular);
  u.head<3>() /= kArm;
  jacobian.row(0) = chain.JacobianGradient(link_, u, v);
}

}  // namespace elastocal
