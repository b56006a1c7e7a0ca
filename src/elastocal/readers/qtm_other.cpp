// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <map>

#include <Eigen/Geometry>

#include "elastocal/readers/csv_lines.hpp"
#include "elastocal/readers/formats.hpp"
#include "elastocal/readers/marker_rows.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kBodyColumns = 16;  // X, Y, Z, three angles, Residual, Rot[0] to Rot[8]
constexpr double kMillimetre = 1e-3;      // QTM exports in mm, always

/// Poses of rigid bodies as QTM exports them beside the positions of markers.
class QtmBodyReader {
 public:
  explicit QtmBodyReader(const ByteSource& source) : source_(source), lines_(source, '\t') {}

  RecordingFile Read() {
    ReadHeader();
    Steps steps("Frame", 1.0, 0.0);
    std::size_t count = 0;
    while (lines_.Next()) {
      if (lines_.blank()) continue;
      if (has_frame_) steps.Check(lines_, lines_.Number(0));
      for (std::size_t b = 0; b < bodies_.names.size(); ++b) {
        AddPose(first_ + kBodyColumns * b);
      }
      ++count;
    }
    if (count == 0) lines_.Fail("no frame below the header");
    if (const auto stated = lines_.Parse(header_["NO_OF_FRAMES"]);
        stated && *stated != static_cast<double>(count)) {
      lines_.Fail("found " + std::to_string(count) + " frames; NO_OF_FRAMES is " +
                  FormatNumber(*stated));
    }
    bodies_.positions = StackRows(positions_, count);
    bodies_.rotations = StackRows(rotations_, count);
    RecordingFile file;
    file.why_no_joints = "a Qualisys TSV has no joint positions";
    file.markers = MarkerTrajectories{source_.name(), {}, rate_, {}};
    AddBodies(bodies_, *file.markers, file.notes);
    return file;
  }

 private:
  void ReadHeader() {
    while (true) {
      lines_.Expect("the row of column names");
      const std::string key = lines_.Name(0);
      if (key == "Frame" || key == "Time" || key.ends_with(" X")) break;
      if (key == "BODY_NAMES") {
        for (std::size_t i = 1; i < lines_.count(); ++i) {
          if (!lines_.Cell(i).empty()) bodies_.names.push_back(lines_.Name(i));
        }
      } else {
        header_.emplace(key, lines_.Name(1));
      }
    }
    has_frame_ = lines_.Cell(0) == "Frame";
    while (lines_.Cell(first_) == "Frame" || lines_.Cell(first_) == "Time") ++first_;
    if (bodies_.names.empty()) lines_.Fail("no line BODY_NAMES above");
    for (std::size_t b = 0; b < bodies_.names.size(); ++b) CheckBody(b);
    bodies_.names = DistinctNames(bodies_.names);
    rate_ = lines_.Parse(header_["FREQUENCY"]).value_or(0.0);
    if (rate_ <= 0.0) {
      lines_.Fail("FREQUENCY: found " + Quote(header_["FREQUENCY"]) +
                  "; frames per second, above 0, were expected");
    }
  }

  /// Angles may have other names; what is read must have these.
  void CheckBody(std::size_t b) const {
    const auto expect = [&](std::size_t column, const std::string& name) {
      if (lines_.Cell(column) != name) lines_.FailCell(column, Quote(name));
    };
    const std::size_t begin = first_ + kBodyColumns * b;
    expect(begin, bodies_.names[b] + " X");
    expect(begin + 1, "Y");
    expect(begin + 2, "Z");
    for (std::size_t k = 0; k < 9; ++k) expect(begin + 7 + k, "Rot[" + std::to_string(k) + "]");
  }

  /// The matrix stands column by column.
  void AddPose(std::size_t begin) {
    const std::array<double, 3> position = lines_.Position(begin);
    Eigen::Matrix3d rotation;
    for (std::size_t k = 0; k < 9; ++k) {
      rotation(static_cast<Eigen::Index>(k)) = lines_.NumberOrGap(begin + 7 + k);
    }
    constexpr double kRounding = 0.01;  // tolerance for matrices with few decimals
    const bool seen = (rotation.transpose() * rotation).isIdentity(kRounding);
    const bool empty = rotation.isZero(0.0) || rotation.array().isNaN().all();
    if (!seen && !empty) lines_.FailCell(begin + 7, "a rotation matrix in Rot[0] to Rot[8]");
    const Eigen::Quaterniond q(seen ? rotation : Eigen::Matrix3d::Identity());
    for (const double x : position) positions_.push_back(seen ? kMillimetre * x : kNaN);
    rotations_.insert(rotations_.end(), {q.x(), q.y(), q.z(), q.w()});
  }

  const ByteSource& source_;
  CsvLines lines_;
  std::map<std::string, std::string> header_;
  BodyPoses bodies_;
  double rate_ = 0.0;
  bool has_frame_ = false;
  std::size_t first_ = 0;  ///< column of the first body
  std::vector<double> positions_, rotations_;
};

/// The value of a line `KEY<tab>value`; empty if there is none.
std::string_view ValueOf(std::string_view head, const std::string& key) {
  std::size_t at = head.starts_with(key + "\t") ? 0 : head.find("\n" + key + "\t");
  if (at == std::string_view::npos) return {};
  at = head.find('\t', at) + 1;
  return Trim(head.substr(at, head.find_first_of("\t\r\n", at) - at));
}

}  // namespace

bool IsQtmOther(std::string_view head) {
  const std::string_view kind = ValueOf(head, "DATA_INCLUDED");
  return (!kind.empty() && kind != "3D") || !ValueOf(head, "FORCE_PLATE_NAME").empty();
}

RecordingFile ReadQtmOther(const ByteSource& source, const ReaderOptions&) {
  std::array<char, 4096> head{};
  const std::string_view bytes(head.data(), source.Read(0, head));
  const std::string kind(ValueOf(bytes, "DATA_INCLUDED"));
  if (kind == "6D") return QtmBodyReader(source).Read();
  RecordingFile file;
  file.why_no_joints = "a Qualisys TSV has no joint positions";
  file.why_no_markers = "DATA_INCLUDED is " + Quote(kind.empty() ? "force" : kind) +
                        "; 3D, positions of markers, or 6D, rigid bodies, was expected";
  return file;
}

}  // namespace elastocal
