#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "elastocal/io/qtm_header.hpp"

namespace elastocal {

/// The numbers of a Qualisys 3-D TSV.
struct QtmFrames {
  Eigen::MatrixXd positions;                 ///< frames x 3 N_M, m; NaN where not seen
  std::vector<std::vector<double>> leading;  ///< columns before those of the markers, at most two
  /// "Frame" or "Time" for each of these; empty where there is one and no row names it.
  std::vector<std::string> leading_names;
};

/// Reads the frames below a header, from the same text. Throws InputError naming file, line and
/// column: cells that are no numbers, markers with only some of their coordinates, rows of unequal
/// length, no frame, another number of frames than the header says.
QtmFrames ReadQtmFrames(std::string_view text, const QtmHeader& header, const std::string& source);

}  // namespace elastocal
