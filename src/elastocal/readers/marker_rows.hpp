// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// Trajectories frame by frame, as readers find them.
class MarkerRows {
 public:
  /// What a file may claim to hold is reserved only up to `frames_at_most`.
  void Reserve(std::size_t markers, std::size_t frames_at_most) {
    numbers_.reserve(3 * markers * frames_at_most);
  }

  /// A position in m. One that is not finite, or exactly 0 0 0, is a gap.
  void Add(double x, double y, double z);
  void AddGap();

  /// The rows so far, all of as many markers as there are names.
  MarkerTrajectories Take(std::string source, std::vector<std::string> names, double rate_hz);

 private:
  std::vector<double> numbers_;
};

/// Names that are all different: where one comes again, "#2" is added, and so on.
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
