// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "elastocal/files/output_files.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/readers/qtm_tsv.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

void CheckNames(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const bool control = std::any_of(name.begin(), name.end(),
                                     [](unsigned char character) { return character < 0x20; });
    if (name.empty() || control || Trim(name) != name) {
      throw InputError("a TSV file cannot hold a marker of the name " + Quote(name));
    }
  }
}

std::string HeaderText(const MarkerTrajectories& trajectories) {
  std::string text = "NO_OF_FRAMES\t" + std::to_string(trajectories.frame_count()) +
                     "\r\nNO_OF_MARKERS\t" + std::to_string(trajectories.marker_count()) +
                     "\r\nFREQUENCY\t" + FormatNumber(trajectories.rate_hz) +
                     "\r\nDATA_INCLUDED\t3D\r\nMARKER_NAMES";
  for (const std::string& name : trajectories.names) text += "\t" + name;
  text += "\r\nFrame\tTime";
  for (const std::string& name : trajectories.names) {
    for (char axis : {'X', 'Y', 'Z'}) text += "\t" + name + " " + axis;
  }
  return text + "\r\n";
}

}  // namespace

void WriteQtmTsv(const std::filesystem::path& file, const MarkerTrajectories& trajectories,
                 int decimals) {
  WriteFile(file, FormatQtmTsv(trajectories, decimals));
}

std::string FormatQtmTsv(const MarkerTrajectories& trajectories, int decimals) {
  CheckNames(trajectories.names);
  constexpr int kTimeDecimals = 5;
  const auto& positions = trajectories.positions;
  std::string text = HeaderText(trajectories);
  // About "-1234.567" and a tab for each number.
  text.reserve(text.size() +
               static_cast<std::size_t>(positions.size()) * static_cast<std::size_t>(decimals + 7));
  for (Eigen::Index i = 0; i < positions.rows(); ++i) {
    InterruptionPoint();
    text += std::to_string(i + 1) + "\t";
    AppendFixed(static_cast<double>(i) / trajectories.rate_hz, kTimeDecimals, text);
    for (Eigen::Index c = 0; c < positions.cols(); ++c) {
      text += '\t';
      if (!std::isnan(positions(i, c))) AppendFixed(1e3 * positions(i, c), decimals, text);
    }
    text += "\r\n";
  }
  return text;
}

}  // namespace elastocal
