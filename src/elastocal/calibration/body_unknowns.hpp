// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/options.hpp"
#include "elastocal/calibration/placement.hpp"
#include "elastocal/robot/error_model.hpp"
#include "elastocal/robot/leg_load.hpp"

namespace elastocal {

/// The unknowns of eq. 14 as the solver's vector x. First come the free parameters in units of
/// ParameterScale, in blocks: T0, each joint, each leg, each marker. For trials follow the pose of
/// each footing and the pose of the waist in each posture, as displacements from the given
/// placement in units of kPoseScale.
class BodyUnknowns {
 public:
  static constexpr double kPoseScale = 0.01;  ///< m and rad
  static constexpr int kWaistBlock = -1;      ///< in Columns: the block of the posture's own waist

  /// `free` holds the indices of the estimated parameters, ascending. All other parameters keep
  /// their value in `delta`. The object keeps references to the model and the placement.
  BodyUnknowns(const ErrorModel& model, const std::vector<int>& free, const Eigen::VectorXd& delta,
               const Placement& placement);

  const std::vector<int>& block_sizes() const { return block_sizes_; }
  /// First entry of a block in x. For the index behind the last block: the size of x.
  int first_entry(int block) const { return first_entry_[block]; }
  /// Entries of x that may not become negative (the compliances), ascending.
  const std::vector<int>& nonnegative() const { return nonnegative_; }
  const std::vector<int>& free() const { return free_; }
  /// Block of a free parameter, which is given by its place in `free()`.
  int block_of(int unknown) const { return block_of_[unknown]; }

  int FootingBlock(int footing) const { return first_footing_block_ + footing; }
  int WaistBlock(int posture) const { return first_waist_block_ + posture; }
  std::vector<int> WaistBlocks() const;
  bool IsMarkerBlock(int block) const { return block >= 0 && is_marker_[block] != 0; }

  Eigen::VectorXd Start() const;  ///< x at `delta` and `placement`
  Eigen::VectorXd ToErrors(const Eigen::VectorXd& x) const;
  Placement ToPlacement(const Eigen::VectorXd& x) const;
  /// Displacement (m), then rotation vector (rad), of a pose block.
  Vector6d PoseStep(const Eigen::VectorXd& x, int block) const;
  Transform FootingPose(const Eigen::VectorXd& x, int footing) const;
  /// Derivative of a footing's motion, in its own axes, with respect to its six unknowns.
  Matrix6d FootingChart(const Eigen::VectorXd& x, int footing) const;

  /// The columns of a Jacobian that belong to one block of unknowns.
  struct Columns {
    int block;                // kWaistBlock: the waist of the posture itself
    std::vector<int> source;  // indices of the columns in the Jacobian
    Eigen::RowVectorXd scale;
  };
  /// Sorts the columns of a Jacobian, which are given by their parameters, into blocks. Columns of
  /// parameters that are not free are left out.
  std::vector<Columns> MapColumns(const std::vector<int>& parameters) const;

  /// The free parameters of one leg: its compliances and torque biases. They act through the
  /// deflection of the leg.
  struct Deflection {
    int block = -1;
    std::vector<int> parameters;
    Eigen::RowVectorXd scale;
  };
  Deflection MapDeflection(int leg) const;

 private:
  void MakeParameterBlocks();

  const ErrorModel& model_;
  const Placement& placement_;
  std::vector<int> free_;
  Eigen::VectorXd fixed_;
  Eigen::VectorXd scale_;        // by unknown parameter
  std::vector<int> block_of_;    // by unknown parameter
  std::vector<char> is_marker_;  // by block
  std::vector<int> block_sizes_, first_entry_, nonnegative_;
  int first_footing_block_ = 0, first_waist_block_ = 0;
};

}  // namespace elastocal
