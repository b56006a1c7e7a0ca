// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/identifiability/root_projection.hpp"
#include "elastocal/robot/error_model.hpp"
#include "elastocal/robot/jacobian.hpp"
#include "elastocal/robot/moving_chain.hpp"

namespace elastocal {

/// The generalized Jacobian Psi_b of the base parameters in one posture (eq. 4), at nominal
/// geometry, and its derivative by the posture. Compliances may be among the parameters. Those of
/// joints (eq. 5) act under the weight of what the joints carry. Those of a leg (eq. 6) move the
/// root link and all markers, under the weight of the whole robot, which stands on that leg alone.
///
/// If the root link is free, Psi_b is the part that no displacement of the whole robot explains
/// (see RootProjection); columns of T0 are then zero.
class PostureRegressor {
 public:
  /// `base` lists the columns: indices into the model's parameters, ascending. Torque biases, and
  /// compliances of a leg that the chain moves, may not be among them (std::invalid_argument).
  /// Keeps a reference to the model.
  PostureRegressor(const ErrorModel& model, const std::vector<int>& base, const MovingChain& chain,
                   RootPose root = RootPose::kConstant);

  int rows() const { return 3 * model_.marker_count(); }
  int columns() const { return static_cast<int>(asked_.size()); }

  /// Psi_b in the posture x of `chain`, rows() x columns(): m/rad, m/m, m/(rad/(N.m)). `shown`, by
  /// row, is 1 for markers that are seen and 0 for others, whose rows are zero; empty: all are
  /// seen.
  Eigen::MatrixXd Evaluate(MovingChain& chain, const Eigen::VectorXd& x,
                           const Eigen::VectorXd& shown = {});

  /// Derivatives by x of the sum of `weight` .* Psi_b with a constant weight (rows() x columns()),
  /// in the posture of the last evaluation and with the markers that were seen there. With weight =
  /// 2 Psi_b M^-1 it is the gradient of log det M.
  Eigen::VectorXd Gradient(MovingChain& chain, const Eigen::MatrixXd& weight);

 private:
  struct MarkerColumn {
    int column;     // of Psi_b
    int source;     // of GeneralizedJacobian::Block
    int parameter;  // of the model
    int joint;      // of the tree; kWaistColumn, kMarkerColumn
  };
  struct PathJoint {
    int joint, motion;  // motion: the parameter whose screw is the joint's own motion
    int variable;       // entry of x; -1: it rests
    double multiplier;
  };
  /// A compliance of a support leg: how it moves the root link, and the load that it bears.
  struct LegColumn {
    int column = 0, leg = 0;
    int entry = 0;  // of the leg's six compliances and of its load
    // By a unit load, a marker at p moves by axis x p + translation.
    Eigen::Vector3d axis = Eigen::Vector3d::Zero(), translation = Eigen::Vector3d::Zero();
    double load = 0.0;

    Eigen::Vector3d Of(const Eigen::Vector3d& p) const { return axis.cross(p) + translation; }
  };
  void LayOut(const MovingChain& chain);
  /// Weights of the columns `base_` before the projection that correspond to weights after it.
  Eigen::MatrixXd Unprojected(const Eigen::MatrixXd& weight) const;
  double Load(int parameter) const;
  double LoadOn(const LegColumn& column, const Eigen::VectorXd& q) const;
  void EvaluateLegs(const Eigen::VectorXd& q);
  void AddMarkerGradient(int marker, const Eigen::MatrixXd& weight,
                         Eigen::VectorXd& gradient) const;
  void AddLoadGradient(MovingChain& chain, const Eigen::MatrixXd& weight,
                       Eigen::VectorXd& gradient) const;

  const ErrorModel& model_;
  std::vector<int> base_;   // with the six of T0 before the others, where the root is free
  std::vector<int> asked_;  // columns of psi_ that were asked for
  Geometry geometry_;
  GeneralizedJacobian jacobian_;
  bool elastic_ = false;
  Eigen::VectorXd x_;
  JointLoads unit_loads_, loads_;
  std::vector<std::vector<MarkerColumn>> columns_;  // by marker, in the order of the path
  std::vector<std::vector<PathJoint>> paths_;       // by marker
  std::vector<LegColumn> legs_;
  Eigen::MatrixXd psi_;    // columns `base_`, before the projection
  Eigen::VectorXd shown_;  // by row; empty: all are seen
  bool free_ = false;
  std::optional<RootProjection> projection_;  // of a free root, in the last posture
};

}  // namespace elastocal
