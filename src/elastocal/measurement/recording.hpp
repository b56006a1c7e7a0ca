#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// Static postures of one robot with the marker positions measured in each: the one type in which
/// real and simulated measurements reach the estimator.
struct Recording {
  std::string source;                     ///< the file, for messages
  std::vector<std::string> marker_names;  ///< in the order of `markers`
  /// postures x coordinates of the robot tree, rad or m. Joints that the file does not contain are
  /// at the position that the project gives them, and listed in `joints_not_recorded`.
  Eigen::MatrixXd q;
  std::vector<std::string> joints_not_recorded;
  /// postures x 3 N_M, m, in a frame fixed with respect to the waist; NaN where a marker was not
  /// seen.
  Eigen::MatrixXd markers;
  Eigen::VectorXd time_s;  ///< empty, or one time a posture
  std::vector<int> line;   ///< line of each posture in the file; empty where there is no file

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
