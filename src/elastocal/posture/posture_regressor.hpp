#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/error_model.hpp"
#include "elastocal/robot/jacobian.hpp"
#include "elastocal/robot/moving_chain.hpp"

namespace elastocal {

/// The base generalized Jacobian Psi_b of one posture (eq. 4): markers by identifiable parameters,
/// at nominal geometry, and how it changes with the posture. Compliances of joints (eq. 5) may be
/// among the parameters: they act under gravity with the root link held.
class PostureRegressor {
 public:
  /// `base`: columns, indices into the model's parameters, ascending; compliances of legs and
  /// torque biases may not be among them (std::invalid_argument). Keeps a reference to the model.
  PostureRegressor(const ErrorModel& model, std::vector<int> base, const MovingChain& chain);

  int rows() const { return 3 * model_.marker_count(); }
  int columns() const { return static_cast<int>(base_.size()); }

  /// Psi_b in the posture x of `chain`, rows() x columns(): m/rad, m/m, m/(rad/(N.m)).
  const Eigen::MatrixXd& Evaluate(MovingChain& chain, const Eigen::VectorXd& x);

  /// Derivatives by x of the sum of `weight` .* Psi_b, the weight (rows() x columns()) being
  /// constant; in the posture of the last evaluation. With weight = 2 Psi_b M^-1 it is the gradient
  /// of log det M.
  Eigen::VectorXd Gradient(MovingChain& chain, const Eigen::MatrixXd& weight);

 private:
  struct MarkerColumn {
    int column;     // of Psi_b
    int source;     // of GeneralizedJacobian::Block
    int parameter;  // of the model
    int joint;      // of the tree; kBaseColumn, kMarkerColumn
  };
  struct PathJoint {
    int joint, motion;  // motion: the parameter whose screw is the joint's own motion
    int variable;       // entry of x; -1: it rests
    double multiplier;
  };
  void LayOut(const MovingChain& chain);
  double Load(int parameter) const;
  void AddMarkerGradient(int marker, const Eigen::MatrixXd& weight,
                         Eigen::VectorXd& gradient) const;
  void AddLoadGradient(MovingChain& chain, const Eigen::MatrixXd& weight,
                       Eigen::VectorXd& gradient) const;

  const ErrorModel& model_;
  std::vector<int> base_;
  Geometry geometry_;
  GeneralizedJacobian jacobian_;
  bool elastic_ = false;
  Eigen::VectorXd x_;
  JointLoads unit_loads_, loads_;
  std::vector<std::vector<MarkerColumn>> columns_;  // by marker, in the order of the path
  std::vector<std::vector<PathJoint>> paths_;       // by marker
  Eigen::MatrixXd psi_;
};

}  // namespace elastocal
