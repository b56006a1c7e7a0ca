// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// Use of a trial: to estimate parameters, or to validate them on motions of another kind (section
/// 6 of the paper).
enum class TrialKind { kCalibration, kSine, kRandom, kRepeatability };

/// One motion of the robot, recorded without a break by cameras and log.
struct Trial {
  std::string name;
  TrialKind kind = TrialKind::kCalibration;
  std::vector<std::string> chains;  ///< chains that it exercises, by their names in the project
  /// Links of the robot tree that stand on the floor and do not move in the trial. If empty, the
  /// root link is held still, unless it is free.
  std::vector<int> support = {};
  bool free_root = false;  ///< nothing ties the robot to the floor
  bool moments = false;    ///< its samples are moments of a motion, as in a sine trial, not rests
  int session = 0;         ///< number of the recording folder that it is from

  bool of_motion() const { return moments || kind == TrialKind::kSine; }
};

/// Static postures of one robot with the marker positions measured in each. Real and simulated
/// measurements reach the estimator in this one type. It holds either a posture table (`trials`
/// empty), measured in a frame fixed to the waist or, where the root is free, in that of cameras in
/// the room; or samples of trials, measured in the cameras' frame.
struct Recording {
  std::string source;                     ///< the file, for messages
  std::vector<std::string> marker_names;  ///< in the order of `markers`
  /// postures x coordinates of the robot tree, rad or m. Joints that the file does not contain have
  /// the position that the project gives, and are listed in `joints_not_recorded`.
  Eigen::MatrixXd q;
  std::vector<std::string> joints_not_recorded;
  /// postures x 3 N_M, m; NaN where a marker was not seen. In a frame fixed with respect to the
  /// waist or, for trials, in the cameras' frame, in which the waist may move.
  Eigen::MatrixXd markers;
  /// postures x joints of the robot tree, N.m or N, as the sensors report them (they balance the
  /// load); NaN for a joint without sensor. No rows if no torques were recorded.
  Eigen::MatrixXd torques;
  /// Links of the force-torque sensors, and their measurements, postures x 6 for each sensor: force
  /// [N] and moment [N.m] that the surroundings (for an ankle: foot and floor) exert on the robot
  /// at the origin of the link's frame, in its axes; NaN where unknown.
  std::vector<int> wrench_links;
  Eigen::MatrixXd wrenches;
  std::vector<Trial> trials;  ///< empty for a posture table
  bool free_root = false;     ///< posture table: the root link has another pose in each posture
  std::vector<int> trial;     ///< for each posture, index into `trials`; empty if `trials` is
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};  ///< in the frame of `markers`, m/s^2
  /// postures x coordinates of q: direction of the last motion of each coordinate, -1 or 1; 0 where
  /// unknown. No rows if nothing is known. NoteApproach fills it.
  Eigen::MatrixXd approach;
  Eigen::VectorXd time_s;   ///< of each posture, for trials on the cameras' clock; may be empty
  std::vector<int> frames;  ///< number of frames of which each posture is the mean; empty: one each
  std::vector<int> line;    ///< line of each posture in the file; empty if there is no file

  int posture_count() const { return static_cast<int>(q.rows()); }
  int marker_count() const { return static_cast<int>(marker_names.size()); }
};

/// The vector of gravity (9.81 m/s^2) in a frame in which the axis `up` points upwards. Throws
/// std::invalid_argument for a text that IsAxis refuses.
Eigen::Vector3d GravityBelow(const std::string& up);

/// Whether the text is one of x, y, z, -x, -y and -z.
bool IsAxis(const std::string& text);

/// Whether marker `m` was seen in posture `i`.
bool Seen(const Recording& recording, int posture, int marker);

/// Measured position of a marker, m.
Eigen::Vector3d MarkerPosition(const Recording& recording, int posture, int marker);

/// Whether the root link has an unknown pose in each posture, and not one pose in all (T0).
bool HasPoseByPosture(const Recording& recording);

/// Whether nothing ties the root link of a posture to the floor.
bool HasFreeRoot(const Recording& recording, int posture);

/// Whether the root link is free in all postures; false without postures.
bool HasFreeRoot(const Recording& recording);

/// Fills `approach` from the order of the postures within each trial (or in the whole table). A
/// joint that did not move (by more than 2e-3 rad or m) keeps the direction of its last motion.
void NoteApproach(Recording& recording);

/// Direction of the last motion of each coordinate, -1 or 1, in a table of positions (rows x
/// coordinates); 0 where unknown. A row is reached from the row before it if both belong to one
/// part. `part` has one number for each row; empty: all rows are one part.
Eigen::MatrixXd ApproachesOf(const Eigen::MatrixXd& q, const std::vector<int>& part);

/// The given postures of a recording, in the given order.
Recording SelectPostures(const Recording& recording, const std::vector<int>& postures);

/// At most `most` (> 0) postures of a recording, evenly spaced in their order.
Recording EvenlyThinned(const Recording& recording, int most);

/// Joins the trials of two recordings of one robot with the same markers and the same gravity.
/// Times and lines of the postures are dropped; wrenches too, unless both have the same sensors.
Recording JoinTrials(const Recording& first, const Recording& second);

}  // namespace elastocal
