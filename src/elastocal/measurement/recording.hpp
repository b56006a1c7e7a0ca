#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// What a trial is for: estimating parameters, or judging them on motions of another kind (section
/// 6 of the paper).
enum class TrialKind { kCalibration, kSine, kRandom, kRepeatability };

/// One motion of the robot, played once with cameras and log running.
struct Trial {
  std::string name;
  TrialKind kind = TrialKind::kCalibration;
  std::vector<std::string> chains;  ///< that it exercises, by their names in the project
  /// Links of the robot tree that stand on the floor and do not move in the trial; empty: the root
  /// link is held.
  std::vector<int> support = {};
};

/// Static postures of one robot with the marker positions measured in each: the one type in which
/// real and simulated measurements reach the estimator. Either a table of postures seen from the
/// waist (`trials` empty) or samples of trials seen by cameras in the laboratory.
struct Recording {
  std::string source;                     ///< the file, for messages
  std::vector<std::string> marker_names;  ///< in the order of `markers`
  /// postures x coordinates of the robot tree, rad or m. Joints that the file does not contain are
  /// at the position that the project gives them, and listed in `joints_not_recorded`.
  Eigen::MatrixXd q;
  std::vector<std::string> joints_not_recorded;
  /// postures x 3 N_M, m; NaN where a marker was not seen. In a frame fixed with respect to the
  /// waist or, of trials, in the cameras' frame, in which the waist may move.
  Eigen::MatrixXd markers;
  /// postures x joints of the robot tree, N.m or N, as the sensors report them (what balances the
  /// load); NaN where there is none. No rows: no torques were recorded.
  Eigen::MatrixXd torques;
  /// Of force-torque sensors: their links, and postures x 6 a sensor: force [N] and moment [N.m]
  /// that the surroundings (for an ankle: foot and floor) exert on the robot at the origin of the
  /// link's frame, in its axes; NaN where unknown.
  std::vector<int> wrench_links;
  Eigen::MatrixXd wrenches;
  std::vector<Trial> trials;  ///< empty for a table of postures
  std::vector<int> trial;     ///< of each posture, index into `trials`; empty with it
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};  ///< in the frame of `markers`, m/s^2
  Eigen::VectorXd time_s;   ///< empty, or one time a posture; of trials, of the cameras' clock
  std::vector<int> frames;  ///< that each posture is the mean of; empty: one
  std::vector<int> line;    ///< line of each posture in the file; empty where there is no file

  int posture_count() const { return static_cast<int>(q.rows()); }
  int marker_count() const { return static_cast<int>(marker_names.size()); }
};

/// Whether marker `m` was seen in posture `i`.
bool Seen(const Recording& recording, int posture, int marker);

/// Its measured position, m.
Eigen::Vector3d MarkerPosition(const Recording& recording, int posture, int marker);

/// The given postures of a recording, in the given order.
Recording SelectPostures(const Recording& recording, const std::vector<int>& postures);

}  // namespace elastocal
