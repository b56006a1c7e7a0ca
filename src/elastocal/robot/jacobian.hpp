// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/error_model.hpp"
#include "elastocal/robot/mdh_frames.hpp"

namespace elastocal {

/// Generalized Jacobian of the marker positions (eq. 4, after Khalil): derivatives with respect to
/// every error parameter, for all chains at once. A marker depends on T0, on the joints between the
/// waist and itself and on its own position; only these columns are computed.
///
/// A displacement of any parameter moves the bodies beyond it as a screw, so that every column is a
/// x p + m: for a rotation, a is its axis and m = o x a with o on the axis; for a translation a is
/// zero and m its direction. Loads, if given, do not depend on the parameters, except on
/// corrections of loads; the columns of compliances are derivatives under the corrected loads. A
/// torque bias has no column here,
/// because through a joint's torsion it would be the same as an error of theta. The structure is
/// laid out once; Evaluate allocates nothing.
class GeneralizedJacobian {
 public:
  enum class LoadsOfRootJoints {
    kConstant,
    kTurning,  ///< loads of joints on the root link turn with what the joint carries (TurnedLoads)
  };

  /// Keeps a reference: the model must outlive it.
  explicit GeneralizedJacobian(const ErrorModel& model,
                               LoadsOfRootJoints root_joints = LoadsOfRootJoints::kConstant);

  /// Positions and derivatives for one posture.
  void Evaluate(const Geometry& geometry, const Eigen::VectorXd& q, const JointLoads& loads = {});

  /// Position of a marker in the reference frame, m. Like everything below, it is that of the last
  /// evaluation.
  auto Position(int marker) const { return positions_.col(marker); }

  /// Indices of the parameters a marker depends on, ascending.
  const std::vector<int>& Columns(int marker) const { return layout_[marker].columns; }

  using BlockMap = Eigen::Map<const Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>>;
  /// 3 x Columns(marker).size(), m/rad and m/m.
  BlockMap Block(int marker) const {
    const MarkerLayout& layout = layout_[marker];
    return {values_.data() + layout.offset, 3, static_cast<Eigen::Index>(layout.columns.size())};
  }

  /// The screw [a; m] by which a parameter (other than a marker's or a linkage's) moves everything
  /// beyond it: its column for a marker at p is a x p + m. See LegScrews.
  Eigen::Matrix<double, 6, 1> Screw(int parameter) const {
    return screws_.row(parameter).matrix().transpose();
  }

  /// The whole matrix with its zeros, 3 N_M x parameters.
  Eigen::MatrixXd Dense() const;

  /// Pose of the root link in the reference frame, and its motion by T0: 6 x 6, screws as in
  /// LegScrews.
  Transform WaistPose() const {
    Transform T_ref_waist = Transform::Identity();
    T_ref_waist.linear() = frames_[0].R;
    T_ref_waist.translation() = frames_[0].p;
    return T_ref_waist;
  }
  Eigen::Matrix<double, 6, 6> WaistScrews() const {
    return screws_.topRows<kWaistParameterCount>().matrix().transpose();
  }

  /// Pose of a leg's foot link in the reference frame.
  const Transform& LegPose(int leg) const { return T_ref_foot_[leg]; }

  /// Indices of the parameters that the foot's pose depends on, ascending: T0 and those of the
  /// leg's joints. (The compliances of the leg act through the waist: see leg_load.hpp.)
  const std::vector<int>& LegColumns(int leg) const { return legs_[leg].columns; }

  /// 6 x LegColumns(leg).size(): the motion of the foot by each parameter, as a screw [a; m] in the
  /// reference frame. a is the rotation, m the velocity of the point of the foot that is at the
  /// reference origin. Any point p of the foot moves by a x p + m.
  const Eigen::Matrix<double, 6, Eigen::Dynamic>& LegScrews(int leg) const {
    return leg_screws_[leg];
  }

 private:
  struct Segment {
    int begin, size;     // run of consecutive rows of screws_
    int parameter = -1;  // of the first row; -1: `begin`
  };
  /// Rows of screws_ for what the errors of a linkage do to bodies beyond some of its joints.
  struct LinkageRows {
    int linkage, row, count;
    std::vector<int> moved;  // of the linkage's joints, by their position in it
  };
  struct BodyLayout {
    int body;
    std::vector<Segment> segments;  // T0 and joint parameters
    std::vector<int> columns;       // the same, one by one
  };
  struct MarkerLayout : BodyLayout {  // its columns end with the marker's own
    Eigen::Index offset;              // of the block in values_
  };

  BodyLayout LayOut(int body, const std::vector<int>& parameter_count);
  void EvaluateScrews(const Geometry& geometry, const Eigen::VectorXd& q, const JointLoads& loads);
  void SetRootCompliance(int row, int axis, const Geometry::JointConstants& constants,
                         const Eigen::Matrix3Xd& about_root, int joint);
  void SetCompliances(int joint, int row, const Geometry::JointConstants& constants,
                      const MdhFrame& twisted, const JointLoads& loads);
  void TurnLoads(int joint, const Geometry::JointConstants& constants, const MdhFrame& twisted,
                 const JointLoads& loads);
  void SetCorrections(int joint, int row, const MdhFrame& deflected, const JointLoads& loads);
  Segment LinkageSegment(int linkage, const std::vector<int>& path);
  void SetLinkages(const Geometry& geometry, const Eigen::VectorXd& q);
  void SetRootCorrections(const Geometry& geometry, const JointLoads& loads);
  void AddLoadCorrections(int joint, const Geometry::JointConstants& constants,
                          const MdhFrame& twisted, const JointLoads& acting,
                          const JointLoads& loads);
  void SetMarkerCorrections(const Geometry& geometry, const JointLoads& loads);
  void CountCorrections(int screw_count);
  void EvaluateMarker(int marker);
  void EvaluateLeg(int leg);

  const ErrorModel& model_;
  LoadsOfRootJoints root_joints_;
  std::vector<int> first_parameter_;                // by joint
  std::vector<int> compliances_;                    // by joint: how many it has
  std::vector<int> corrections_;                    // likewise
  int root_corrections_ = 0;                        // of the root link, after T0
  int load_corrections_ = 0;                        // after these
  int first_load_row_ = 0;                          // of screws_: by body, then by correction
  int first_marker_correction_ = 0;                 // parameter; those of markers come last
  std::vector<LinkageRows> linkage_rows_;           // one for each set of joints that is needed
  int row_count_ = 0;                               // of screws_
  std::vector<MarkerLayout> layout_;                // by marker
  std::vector<BodyLayout> legs_;                    // by leg
  std::vector<MdhFrame> frames_;                    // by body
  Eigen::Array<double, Eigen::Dynamic, 6> screws_;  // parameters (T0, joints) x [a, m]
  Eigen::Matrix3Xd positions_;
  Eigen::VectorXd values_;
  std::vector<Transform> T_ref_foot_;                                 // by leg
  std::vector<Eigen::Matrix<double, 6, Eigen::Dynamic>> leg_screws_;  // by leg
};

}  // namespace elastocal
