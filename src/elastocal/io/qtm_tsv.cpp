#include "elastocal/io/qtm_tsv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "elastocal/io/output_files.hpp"
#include "elastocal/io/qtm_frames.hpp"
#include "elastocal/io/text.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

constexpr double kMmPerMetre = 1e3;

/// Judges the columns Frame and Time, and finds the rate.
class Timing {
 public:
  Timing(const QtmHeader& header, const QtmFrames& frames, const std::string& source)
      : header_(header), frames_(frames), source_(source) {}

  double Rate() const {
    double rate = header_.rate_hz;
    for (std::size_t i = 0; i < frames_.leading.size(); ++i) {
      const std::vector<double>& column = frames_.leading[i];
      if (IsFrameColumn(i)) {
        CheckSteps("Frame", column, 1.0, 0.0);
      } else if (column.size() > 1) {
        rate = RateFromTime(column);
      }
    }
    if (rate > 0.0 && std::isfinite(rate)) return rate;
    throw InputError(source_ +
                     ": the frame rate is not known; give it in Hz in a line of its own above the "
                     "frames, FREQUENCY<tab>100, or export the file with the column Time");
  }

 private:
  [[noreturn]] void Fail(std::size_t frame, const std::string& message) const {
    throw InputError(Place(source_, header_.data_line + static_cast<int>(frame)) + message);
  }

  /// One column that no row names holds frame numbers if it counts by one.
  bool IsFrameColumn(std::size_t i) const {
    if (!frames_.leading_names.empty()) return frames_.leading_names[i] == "Frame";
    return WrongStep(frames_.leading[i], 1.0, 0.0) == 0;
  }

  double RateFromTime(const std::vector<double>& time) const {
    const std::size_t last = time.size() - 1;
    const double elapsed = time[last] - time[0];
    if (!(elapsed > 0.0)) Fail(last, "column Time: not later than in the first frame");
    const double rate =
        header_.rate_hz > 0.0 ? header_.rate_hz : static_cast<double>(last) / elapsed;
    // Times are rounded; half a frame tells a frame left out from rounding.
    CheckSteps("Time", time, 1.0 / rate, 0.5 / rate);
    if (std::abs(elapsed * rate - static_cast<double>(last)) >= 0.5) {
      Fail(last, "column Time: from the first frame to this one " + FormatNumber(elapsed) +
                     " s pass; by FREQUENCY, " + FormatNumber(rate) + ", it is " +
                     FormatNumber(static_cast<double>(last) / rate) + " s");
    }
    return rate;
  }

  /// The first entry that does not follow the one before by `step`; 0 where all do.
  static std::size_t WrongStep(const std::vector<double>& values, double step, double tolerance) {
    for (std::size_t i = 1; i < values.size(); ++i) {
      if (!(std::abs(values[i] - values[i - 1] - step) <= tolerance)) return i;
    }
    return 0;
  }

  void CheckSteps(const std::string& name, const std::vector<double>& values, double step,
                  double tolerance) const {
    const std::size_t i = WrongStep(values, step, tolerance);
    if (i == 0) return;
    Fail(i, "column " + name + ": found " + FormatNumber(values[i]) + " after " +
                FormatNumber(values[i - 1]) + "; steps of " + FormatNumber(step) +
                " were expected, with no frame left out");
  }

  const QtmHeader& header_;
  const QtmFrames& frames_;
  const std::string& source_;
};

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

void AppendFixed(double value, int decimals, std::string& text) {
  // The largest double has 309 digits before the point.
  std::array<char, 340> buffer;
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                          std::chars_format::fixed, decimals);
  text.append(buffer.data(), end);
}

}  // namespace

MarkerTrajectories ReadQtmTsv(const std::filesystem::path& file) {
  return ParseQtmTsv(ReadFile(file), file.string());
}

MarkerTrajectories ParseQtmTsv(std::string_view text, const std::string& source) {
  const std::size_t nul = text.find('\0');
  if (nul != std::string_view::npos) {
    const auto line =
        1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(nul), '\n');
    throw InputError(Place(source, static_cast<int>(line)) +
                     "found a NUL byte; a table (text) was expected");
  }
  const QtmHeader header = ReadQtmHeader(text, source);
  QtmFrames frames = ReadQtmFrames(text, header, source);
  MarkerTrajectories result;
  result.source = source;
  result.names = header.names;
  result.rate_hz = Timing(header, frames, source).Rate();
  result.positions = std::move(frames.positions);
  return result;
}

void WriteQtmTsv(const std::filesystem::path& file, const MarkerTrajectories& trajectories,
                 int decimals) {
  CheckNames(trajectories.names);
  constexpr int kTimeDecimals = 5;
  const auto& positions = trajectories.positions;
  std::string text = HeaderText(trajectories);
  // About "-1234.567" and a tab for each number.
  text.reserve(text.size() +
               static_cast<std::size_t>(positions.size()) * static_cast<std::size_t>(decimals + 7));
  for (Eigen::Index i = 0; i < positions.rows(); ++i) {
    text += std::to_string(i + 1) + "\t";
    AppendFixed(static_cast<double>(i) / trajectories.rate_hz, kTimeDecimals, text);
    for (Eigen::Index c = 0; c < positions.cols(); ++c) {
      text += '\t';
      if (!std::isnan(positions(i, c))) AppendFixed(kMmPerMetre * positions(i, c), decimals, text);
    }
    text += "\r\n";
  }
  WriteFile(file, text);
}

}  // namespace elastocal
