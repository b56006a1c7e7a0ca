// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/options.hpp"
#include "elastocal/calibration/placement.hpp"
#include "elastocal/robot/error_model.hpp"
#include "elastocal/robot/leg_load.hpp"

namespace elastocal {

/// How the unknowns of eq. 14 stand in the solver's vector x: the free parameters in units of
/// ParameterScale, in blocks: T0, each joint, each leg, each marker; then, of trials, the pose of
/// each footing and that of the waist in each posture, as displacements in units of kPoseScale from
/// where they were.
class BodyUnknowns {
 public:
  static constexpr double kPoseScale = 0.01;  ///< m and rad
  static constexpr int kWaistBlock = -1;      ///< in Columns: that of the posture's own waist

  /// `free`: indices of the estimated parameters, ascending; all others stay as in `delta`. Keeps
  /// references to the model and the placement.
  BodyUnknowns(const ErrorModel& model, const std::vector<int>& free, const Eigen::VectorXd& delta,
               const Placement& placement);

  const std::vector<int>& block_sizes() const { return block_sizes_; }
  /// First entry of a block in x; of the one behind the last: the size of x.
  int first_entry(int block) const { return first_entry_[block]; }
  /// Entries that may not become negative, ascending: compliances.
  const std::vector<int>& nonnegative() const { return nonnegative_; }
  const std::vector<int>& free() const { return free_; }
  int block_of(int unknown) const { return block_of_[unknown]; }  ///< of a free parameter

  int FootingBlock(int footing) const { return first_footing_block_ + footing; }
  int WaistBlock(int posture) const { return first_waist_block_ + posture; }
  std::vector<int> WaistBlocks() const;
  bool IsMarkerBlock(int block) const { return block >= 0 && is_marker_[block] != 0; }

  Eigen::VectorXd Start() const;  ///< at `delta` and `placement`
  Eigen::VectorXd ToErrors(const Eigen::VectorXd& x) const;
  Placement ToPlacement(const Eigen::VectorXd& x) const;
  Vector6d PoseStep(const Eigen::VectorXd& x, int block) const;  ///< m and rad
  Transform FootingPose(const Eigen::VectorXd& x, int footing) const;
  /// Derivative of a footing's motion, in its own axes, by its unknowns.
  Matrix6d FootingChart(const Eigen::VectorXd& x, int footing) const;

  /// Columns of one block among those of a Jacobian.
  struct Columns {
    int block;                // kWaistBlock: the posture's own
    std::vector<int> source;  // columns of the Jacobian
    Eigen::RowVectorXd scale;
  };
  /// Which of a Jacobian's columns, given by their parameters, belong to unknowns.
  std::vector<Columns> MapColumns(const std::vector<int>& parameters) const;

  /// Unknowns that act through the deflection of a leg.
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
