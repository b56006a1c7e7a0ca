// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// Collects trajectories frame by frame, as readers find them.
class MarkerRows {
 public:
  /// A position in m. One that is not finite, or exactly 0 0 0, is a gap.
  void Add(double x, double y, double z);
  void AddGap();

  /// Forgets the last so many positions.
  void RemoveLast(std::size_t markers);

  /// The trajectories of the rows so far, each of which must have as many markers as there are
  /// names. Rows are freed while they are copied, so that little more memory is needed than for the
  /// result.
  MarkerTrajectories Take(std::string source, std::vector<std::string> names, double rate_hz);

 private:
  void Append(double x, double y, double z);

  std::vector<std::vector<double>> blocks_;  ///< of equal size, except the last
};

/// Makes all names different: "#2" is added to the second one of a name, "#3" to the third, and so
/// on.
std::vector<std::string> DistinctNames(const std::vector<std::string>& names);

/// Poses of rigid bodies over the frames of a recording.
struct BodyPoses {
  std::vector<std::string> names;
  Eigen::MatrixXd positions;  ///< frames x 3 N, m; NaN where not seen
  Eigen::MatrixXd rotations;  ///< frames x 4 N, quaternions x y z w; need not have length 1
};

/// Adds the four points of each body to the markers (RecordingFile::markers), which must have as
/// many frames (none at all: rate and frames are those of the bodies). A body whose points have
/// the names of markers is left out, and `notes` gets a sentence.
void AddBodies(const BodyPoses& bodies, MarkerTrajectories& markers,
               std::vector<std::string>& notes);

}  // namespace elastocal
