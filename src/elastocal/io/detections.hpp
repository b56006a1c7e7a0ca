// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/project/project.hpp"

namespace elastocal {

/// A tag that a camera saw in a frame.
struct Detection {
  std::string frame;
  int instrument = 0;      ///< index into the instruments of the project's setup
  Eigen::VectorXd pixels;  ///< as SeenTag measures
  int line = 0;            ///< line of its first corner in the file
};

/// Whether a table has the columns `tag` and `corner`.
bool IsDetectionTable(const std::filesystem::path& file);

/// Reads a table of corners: columns frame, tag, corner (0 to 3), u, v [px], and camera where the
/// project has several. Throws InputError naming file, line and column: an unknown tag or camera, a
/// corner that is not 0 to 3 or comes twice, a tag without all of its corners, what is no number.
std::vector<Detection> ReadDetections(const std::filesystem::path& file, const Project& project);

}  // namespace elastocal
