#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/contact/contact_spread.hpp"
#include "elastocal/optim/least_squares.hpp"
#include "elastocal/robot/jacobian.hpp"
#include "elastocal/robot/shared_support.hpp"

namespace elastocal {

/// All that is estimated from touches, SI.
struct ContactValues {
  Eigen::VectorXd robot;                     ///< errors, one a parameter of the robot
  std::vector<Eigen::Vector2d> plate_tilts;  ///< by plate, see EvaluateTouch
  std::vector<TablePlane> tables;            ///< by plate
  std::vector<Eigen::Vector3d> sessions;     ///< by session: added to height and tilts of the table
};

/// The nominal robot; each table level, at the mean height that nominal touches have, its pivot in
/// their middle.
ContactValues NominalContacts(const ContactModel& model, const Touches& touches);

/// What of it is estimated; the rest stays.
struct ContactFreedom {
  bool robot = true, plates = true, tables = true, sessions = true;
};

/// The feet in one posture, as the errors put them.
std::vector<StandingFoot> FeetOf(const ContactModel& model, const GeneralizedJacobian& jacobian);

/// Loads of all joints in each touch.
std::vector<JointLoads> ContactLoads(const ContactModel& model, const Touches& touches,
                                     const Eigen::VectorXd& errors);

/// Touches as a least-squares problem: for every touch what is left of it (TouchResidual), for
/// every other unknown its deviation from nominal; each over the standard deviation of its source.
/// The heights of tables have 1 m.
///
/// Unknowns, in blocks: those of the robot by joint, the tilts of each plate, the plane of each
/// table, the effect of each session.
class ContactResiduals : public LeastSquaresProblem {
 public:
  /// Keeps references. `weights`: by touch; 0: it takes no part.
  ContactResiduals(const ContactModel& model, const Touches& touches,
                   const std::vector<JointLoads>& loads, const ContactSpread& spread,
                   const std::vector<double>& weights, const ContactFreedom& freedom,
                   const ContactValues& at);

  Eigen::VectorXd Start() const;
  ContactValues ToValues(const Eigen::VectorXd& x) const;
  /// Entry of x of an unknown of the robot; -1: it is not free.
  int RobotEntry(int unknown) const { return free_.robot ? robot_entry_[unknown] : -1; }
  /// Value of one in each entry of x, SI.
  const Eigen::VectorXd& scale() const { return scale_; }
  /// First entry of a plate's, table's or session's block.
  int FirstEntry(int block) const { return first_entry_[block]; }
  int PlateBlock(int plate) const { return plate_block_ + plate; }
  int TableBlock(int plate) const { return table_block_ + plate; }
  int SessionBlock(int session) const { return session_block_ + session; }

  /// Of each row of a residual block (the first blocks are the touches), its source, -1: none.
  const std::vector<int>& Sources(int block) const { return sources_[block]; }
  /// What is left of a touch, m and rad; its standard deviations are those of its sources.
  const Eigen::Vector3d& Left(int touch) const { return left_[touch]; }

  void Evaluate(const Eigen::VectorXd& x, bool with_jacobians) override;
  const Eigen::VectorXd& Residual(int block) const override { return residuals_[block]; }
  const RowMajorMatrix& Jacobian(int block) const override { return jacobians_[block]; }

 private:
  /// Where the derivatives of a leg's parameters go among the columns of a touch.
  struct Column {
    int source, target;
    double scale;
  };
  struct PlateLayout {
    std::vector<int> blocks;                   // of the robot that its touches depend on
    std::vector<std::vector<Column>> of_legs;  // feet, then the plate
    int width = 0;                             // columns of the robot
  };

  void AddRobotBlocks();
  void AddBlock(int size, double scale);
  void AddPrior(int block, const std::vector<int>& sources, const std::vector<double>& units);
  void LayOutPlate(int plate);
  void AddTouches();
  void AddPriors();
  void EvaluateTouchBlock(int touch, const ContactValues& values, const Geometry& geometry,
                          bool with_jacobians);
  double SdOf(int source) const;

  const ContactModel& model_;
  const Touches& touches_;
  const std::vector<JointLoads>& loads_;
  const ContactSpread& spread_;
  const std::vector<double>& weights_;
  ContactFreedom free_;
  ContactValues at_;
  GeneralizedJacobian jacobian_;
  std::vector<int> robot_entry_;     // by unknown of the robot
  std::vector<int> block_of_entry_;  // likewise
  std::vector<int> first_entry_;     // by block
  int plate_block_ = 0, table_block_ = 0, session_block_ = 0;
  Eigen::VectorXd scale_;
  std::vector<PlateLayout> layout_;                     // by plate
  std::vector<std::vector<int>> sources_;               // by residual block
  std::vector<std::vector<double>> weights_of_priors_;  // by prior block: of its rows
  std::vector<Eigen::Vector3d> left_;
  std::vector<Eigen::VectorXd> residuals_;
  std::vector<RowMajorMatrix> jacobians_;
};

}  // namespace elastocal
