// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/utf8.hpp"
#include "elastocal/readers/c3d_parameters.hpp"
#include "elastocal/readers/formats.hpp"
#include "elastocal/readers/lengths.hpp"
#include "elastocal/readers/marker_rows.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr double kWord = 65536.0;
constexpr std::uint64_t kC3dBlockSize = 512;

/// Place and layout of the data.
struct C3dLayout {
  std::size_t points = 0;        ///< of a frame, 4 numbers each
  std::size_t analog = 0;        ///< analogue numbers of a frame, behind the points
  std::size_t number_bytes = 2;  ///< 4: real numbers
  double scale = 1.0;            ///< of integers
  std::uint64_t first_byte = 0;  ///< of the first frame
  std::uint64_t frames = 0;

  std::uint64_t frame_bytes() const { return number_bytes * (4 * points + analog); }
};

class C3dReader {
 public:
  C3dReader(const ByteSource& source, const ReaderOptions& options)
      : source_(source), options_(options), parameters_(ReadC3dParameters(source)) {
    source_.ReadAll(0, header_, "the header");
  }

  RecordingFile Read() {
    FindLayout();
    layout_.frames = FrameCount();
    const std::vector<std::size_t> points = NamedPoints();
    RecordingFile file;
    file.up = Up();
    file.why_no_joints = "a C3D file has no joint positions";
    if (points.empty()) {
      file.why_no_markers = "none of its " + std::to_string(layout_.points) + " points has a label";
    } else {
      const double unit = UnitOf(parameters_.Text("POINT:UNITS"), options_.unit, source_.name());
      file.markers = ReadPoints(points, unit);
    }
    if (layout_.analog > 0) {
      notes_.push_back(std::to_string(layout_.analog) +
                       " analogue numbers a frame are passed over");
    }
    file.notes = std::move(notes_);
    return file;
  }

 private:
  double HeaderWord(std::size_t word) const {
    const std::int16_t number = C3dInteger(&header_[2 * (word - 1)], parameters_.processor);
    return number < 0 ? number + kWord : number;
  }

  std::size_t Whole(double number, const std::string& what, double most) const {
    if (number >= 0.0 && number <= most && number == std::floor(number)) {
      return static_cast<std::size_t>(number);
    }
    throw InputError(source_.name() + ": " + what + ": found " + FormatNumber(number) +
                     "; a whole number up to " + FormatNumber(most) + " was expected");
  }

  void FindLayout() {
    layout_.points = Whole(parameters_.Unsigned("POINT:USED", HeaderWord(2)), "POINT:USED", 65535);
    layout_.analog = static_cast<std::size_t>(HeaderWord(3));
    double scale = C3dReal(&header_[12], parameters_.processor);
    if (const C3dParameter* found = parameters_.Find("POINT:SCALE")) {
      if (!found->numbers.empty()) scale = found->numbers[0];
    }
    if (!std::isfinite(scale) || scale == 0.0) {
      throw InputError(source_.name() + ": POINT:SCALE: found " + FormatNumber(scale) +
                       "; a number other than 0 was expected");
    }
    layout_.number_bytes = scale < 0.0 ? 4 : 2;
    layout_.scale = std::abs(scale);
    const double block = parameters_.Unsigned("POINT:DATA_START", HeaderWord(9));
    const std::size_t first = Whole(block, "POINT:DATA_START", 65535);
    if (first < 2) source_.Fail(16, "the data begin before block 2");
    layout_.first_byte = kC3dBlockSize * (first - 1);
    if (layout_.points == 0) throw InputError(source_.name() + ": POINT:USED is 0: no points");
  }

  /// Number of frames. Counts above 65535 do not fit into the original field of the format, and
  /// makers store them in several other places.
  std::uint64_t FrameCount() {
    const std::uint64_t bytes =
        source_.size() > layout_.first_byte ? source_.size() - layout_.first_byte : 0;
    const std::uint64_t room = bytes / layout_.frame_bytes();
    const double header = HeaderWord(5) - HeaderWord(4) + 1.0;
    double stated = parameters_.Unsigned("POINT:FRAMES", header);
    bool saturated = stated == kWord - 1.0 || HeaderWord(5) == kWord - 1.0;
    const double by_long = parameters_.Unsigned("POINT:LONG_FRAMES", 0.0);
    const double start = Field("TRIAL:ACTUAL_START_FIELD"), end = Field("TRIAL:ACTUAL_END_FIELD");
    if (start > 0.0 && end >= start) {
      stated = end - start + 1.0;
      saturated = false;
    } else if (by_long > 0.0) {
      stated = by_long;
      saturated = false;
    }
    const auto limit = static_cast<double>(std::numeric_limits<int>::max());
    const std::uint64_t count = Whole(stated, "the number of frames", limit);
    if (count > room) {
      source_.Fail(source_.size(), "the file ends after " + std::to_string(room) + " of " +
                                       std::to_string(count) + " frames");
    }
    // What follows the last frame only fills the last block, of 512 bytes.
    const std::uint64_t filling = 1 + kC3dBlockSize / layout_.frame_bytes();
    if (room <= count + filling) return count;
    const std::uint64_t wrapped = (room - count) / 65536 * 65536;
    if (wrapped > 0 && room - count - wrapped <= filling) {
      notes_.push_back("the file says " + std::to_string(count) + " frames; by its size they are " +
                       std::to_string(count + wrapped) + ", a count of 16 bits overflowed");
      return count + wrapped;
    }
    if (saturated) {
      notes_.push_back("the number of frames, " + std::to_string(room) +
                       ", is by the size of the file: its count ends at 65535");
      return std::min<std::uint64_t>(room, static_cast<std::uint64_t>(limit));
    }
    notes_.push_back("behind the last frame are " +
                     std::to_string(bytes - count * layout_.frame_bytes()) +
                     " bytes that are not read");
    return count;
  }

  /// A frame number of 32 bits in two words, or a real number.
  double Field(const std::string& name) const {
    const double low = parameters_.Unsigned(name, 0.0), high = parameters_.Unsigned(name, 0.0, 1);
    return low + kWord * high;
  }

  double Rate() const {
    double rate = C3dReal(&header_[20], parameters_.processor);
    if (const C3dParameter* found = parameters_.Find("POINT:RATE")) {
      if (!found->numbers.empty()) rate = found->numbers[0];
    }
    if (rate > 0.0 && std::isfinite(rate)) return rate;
    throw InputError(source_.name() + ": POINT:RATE: found " + FormatNumber(rate) +
                     "; frames per second, above 0, were expected");
  }

  /// Y_SCREEN is the axis that points up on the screen.
  std::string Up() const {
    std::string axis = parameters_.Text("POINT:Y_SCREEN");
    if (axis.size() == 1) axis = "+" + axis;
    if (axis.size() != 2 || (axis[0] != '+' && axis[0] != '-')) return "";
    const char letter = static_cast<char>(std::tolower(static_cast<unsigned char>(axis[1])));
    if (letter < 'x' || letter > 'z') return "";
    return (axis[0] == '-' ? "-" : "") + std::string(1, letter);
  }

  /// Lists that are longer than 255 go on in a second parameter, and so on.
  std::vector<std::string> Texts(const std::string& name) const {
    std::vector<std::string> texts;
    for (int i = 1;; ++i) {
      const C3dParameter* const found = parameters_.Find(i == 1 ? name : name + std::to_string(i));
      if (!found) return texts;
      texts.insert(texts.end(), found->texts.begin(), found->texts.end());
    }
  }

  /// Points with a label that are positions of markers; Vicon has results of models among them.
  std::vector<std::size_t> NamedPoints() {
    const std::vector<std::string> labels = Texts("POINT:LABELS");
    std::set<std::string> others;
    for (const char* kind : {"ANGLES", "FORCES", "MOMENTS", "POWERS", "SCALARS", "REACTIONS"}) {
      for (const std::string& text : Texts("POINT:" + std::string(kind))) others.insert(text);
    }
    std::vector<std::size_t> points;
    std::size_t results = 0;
    for (std::size_t i = 0; i < std::min(layout_.points, labels.size()); ++i) {
      if (labels[i].empty()) continue;
      RequireLabel(labels[i]);
      if (others.contains(labels[i])) {
        ++results;
        continue;
      }
      points.push_back(i);
      names_.push_back(labels[i]);
    }
    if (results > 0) {
      notes_.push_back(std::to_string(results) +
                       " points are angles, forces and the like, and are passed over");
    }
    if (const std::size_t unnamed = layout_.points - points.size() - results; unnamed > 0) {
      notes_.push_back(std::to_string(unnamed) + " points have no label and are passed over");
    }
    return points;
  }

  void RequireLabel(const std::string& label) const {
    if (IsUtf8(label)) return;
    source_.Fail(parameters_.Find("POINT:LABELS")->offset, "a label is not UTF-8");
  }

  MarkerTrajectories ReadPoints(const std::vector<std::size_t>& points, double unit) const {
    MarkerRows rows;
    const auto width = static_cast<std::size_t>(layout_.frame_bytes());
    const std::size_t block = std::max<std::size_t>(1, (1u << 18) / width);  // frames at a time
    std::vector<char> bytes(width * block);
    for (std::uint64_t frame = 0; frame < layout_.frames; frame += block) {
      const auto count =
          static_cast<std::size_t>(std::min<std::uint64_t>(block, layout_.frames - frame));
      source_.ReadAll(layout_.first_byte + frame * width, {bytes.data(), count * width},
                      "the frames from " + std::to_string(frame) + " on");
      for (std::size_t i = 0; i < count; ++i) {
        for (const std::size_t point : points) {
          AddPoint(&bytes[i * width + 4 * point * layout_.number_bytes], unit, rows);
        }
      }
    }
    return rows.Take(source_.name(), DistinctNames(names_), Rate());
  }

  /// Three coordinates and the residual, which is negative where the point was not seen.
  void AddPoint(const char* from, double unit, MarkerRows& rows) const {
    std::array<double, 4> number{};
    for (std::size_t k = 0; k < 4; ++k, from += layout_.number_bytes) {
      number[k] = layout_.number_bytes == 4
                      ? static_cast<double>(C3dReal(from, parameters_.processor))
                      : C3dInteger(from, parameters_.processor);
    }
    if (!(number[3] >= 0.0)) return rows.AddGap();
    const double scale = layout_.number_bytes == 4 ? unit : unit * layout_.scale;
    rows.Add(scale * number[0], scale * number[1], scale * number[2]);
  }

  const ByteSource& source_;
  const ReaderOptions& options_;
  C3dParameters parameters_;
  std::array<char, kC3dBlockSize> header_{};
  C3dLayout layout_;
  std::vector<std::string> names_, notes_;
};

}  // namespace

bool IsC3d(std::string_view head) {
  // Letters come after 8: no text begins like this.
  return head.size() > 4 && head[1] == 0x50 && head[0] >= 2 && head[0] <= 8;
}

RecordingFile ReadC3d(const ByteSource& source, const ReaderOptions& options) {
  return C3dReader(source, options).Read();
}

}  // namespace elastocal
