// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/observation/observed_posture.hpp"
#include "elastocal/optim/least_squares.hpp"

namespace elastocal {

/// What a fit estimates; the rest stays fixed.
struct ObservationFreedom {
  bool robot = true;
  bool mountings = true;     ///< quantities that belong to the robot
  bool surroundings = true;  ///< other quantities
  bool effects = true;       ///< effects of sessions
};

/// Observations as a least-squares problem: the residual of every observation, and the deviation of
/// every unknown from nominal, each divided by the standard deviation of its source. Unknowns that
/// an earlier calibration tells have its prior instead, together in the last residual block.
///
/// Order of the unknowns, in blocks: those of the robot by joint, then the free quantities and
/// effects.
class ObservationResiduals : public LeastSquaresProblem {
 public:
  /// Keeps references. `loads` are by posture (empty: nothing is elastic), `weights` by
  /// observation; with weight 0 an observation takes no part.
  ObservationResiduals(const ObservedRobot& model, const Observations& observations,
                       const std::vector<JointLoads>& loads, const Spread& spread,
                       const std::vector<double>& weights, const ObservationFreedom& freedom,
                       const ObservedValues& at);

  Eigen::VectorXd Start() const;
  ObservedValues ToValues(const Eigen::VectorXd& x) const;
  /// Entry of x of an unknown of the robot; first entry of a quantity, or of the effect of a
  /// session. -1: it is not free.
  int RobotEntry(int unknown) const { return free_.robot ? robot_entry_[unknown] : -1; }
  int QuantityEntry(int quantity) const { return FirstEntry(quantity_block_[quantity]); }
  int EffectEntry(int effect) const { return FirstEntry(effect_block_[effect]); }
  /// SI value of one unit in each entry of x.
  const Eigen::VectorXd& scale() const { return scale_; }

  /// The source of each row of a residual block. The first blocks are the observations; the block
  /// of an earlier calibration has no sources.
  const std::vector<int>& Sources(int block) const { return sources_[block]; }
  /// Information of the priors on the robot's entries of x, which are the first ones.
  Eigen::MatrixXd RobotPriorInformation() const;
  /// Residual of an observation, SI.
  const Eigen::VectorXd& Left(int observation) const { return left_[observation]; }

  void Evaluate(const Eigen::VectorXd& x, bool with_jacobians) override;
  const Eigen::VectorXd& Residual(int block) const override { return residuals_[block]; }
  const RowMajorMatrix& Jacobian(int block) const override { return jacobians_[block]; }

 private:
  /// Target column, in the Jacobian of an observation, of a derivative by a leg's parameter.
  struct Column {
    int source, target;
    double scale;
  };
  struct InstrumentLayout {
    std::vector<int> blocks;  // the robot's blocks on which its observations depend
    std::vector<int> legs;    // by link of the instrument; -1: the root link
    std::vector<std::vector<Column>> of_feet;  // by foot
    std::vector<std::vector<Column>> of_links;
    int width = 0;  // number of columns of the robot
  };
  int FirstEntry(int block) const { return block < 0 ? -1 : first_entry_[block]; }
  void AddRobotBlocks();
  int AddBlock(int size);
  void AddPrior(int block, const std::vector<int>& sources, const std::vector<double>& units);
  void AddRobotPriors();
  void AddEarlier();
  InstrumentLayout LayOut(const Instrument& instrument) const;
  std::vector<Column> ColumnsOf(int leg, const std::vector<int>& first_column) const;
  void AddObservations();
  void AddPriors();
  void EvaluateObservation(int index, const ObservedValues& values, bool with_jacobians);
  void FillJacobian(int index, const ObservationResidual& at);

  const ObservedRobot& model_;
  const Observations& observations_;
  const std::vector<JointLoads>& loads_;
  const Spread& spread_;
  const std::vector<double>& weights_;
  ObservationFreedom free_;
  ObservedValues at_;
  ObservedPosture posture_;
  std::vector<int> robot_entry_;     // by unknown of the robot
  std::vector<int> block_of_entry_;  // likewise
  std::vector<int> first_entry_;     // by block
  int robot_blocks_ = 0;
  std::vector<int> quantity_block_, effect_block_;  // -1: not free
  Eigen::VectorXd scale_;
  std::vector<InstrumentLayout> layout_;      // by instrument
  std::vector<std::vector<int>> by_posture_;  // indices of the observations
  std::vector<std::vector<int>> sources_;     // by residual block
  /// A row of a prior: its column in the block, and its weight.
  struct PriorRow {
    int column;
    double weight;
  };
  std::vector<std::vector<PriorRow>> priors_;  // by prior block
  Eigen::VectorXd earlier_offset_;             // empty: there is no earlier calibration
  std::vector<Eigen::VectorXd> left_;
  std::vector<Eigen::VectorXd> residuals_;
  std::vector<RowMajorMatrix> jacobians_;
};

}  // namespace elastocal
