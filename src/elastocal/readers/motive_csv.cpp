// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <Eigen/Geometry>

#include "elastocal/readers/csv_lines.hpp"
#include "elastocal/readers/formats.hpp"
#include "elastocal/readers/lengths.hpp"
#include "elastocal/readers/marker_rows.hpp"

namespace elastocal {
namespace {

/// What stands in a column below its rows of header.
struct MotiveColumn {
  std::string type, name, quantity;  ///< "Marker", "LHAND:Marker1", "Position"
  std::string axis;                  ///< "X"
};

/// The first columns of what is read of a rigid body.
struct MotiveBody {
  std::string name;
  std::size_t rotation = 0, position = 0;  ///< 0: not found yet (column 0 is the frame's number)
  std::string axes;                        ///< of the columns of rotation: "XYZW", "XYZ", "ZYX" ..
};

constexpr std::string_view kRotationTypes = "Quaternion, XYZ, XZY, YXZ, YZX, ZXY or ZYX";

/// Rotation by Euler angles [deg] (by axis): about the first axis of `order`, then about the turned
/// second, then about the turned third. This is the convention of Motive 1.6 and later (relative,
/// right-handed).
Eigen::Quaterniond FromEulerAngles(const std::string& order, const Eigen::Vector3d& angles_deg) {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  for (const char axis : order) {
    const int k = axis - 'X';
    rotation = rotation * Eigen::AngleAxisd(angles_deg[k] * M_PI / 180.0, Eigen::Vector3d::Unit(k));
  }
  return rotation;
}

/// Exports of OptiTrack Motive: measured markers (type Marker) and rigid bodies with quaternions or
/// Euler angles. Markers as a rigid body's model expects them, bones and qualities are passed over.
class MotiveReader {
 public:
  MotiveReader(const ByteSource& source, const ReaderOptions& options)
      : source_(source), options_(options), lines_(source, FindFirstSeparator(source)) {}

  RecordingFile Read() {
    ReadTakeLine();
    ReadColumnRows();
    FindColumns();
    ReadFrames();
    RecordingFile file;
    file.why_no_joints = "a Motive CSV has no joint positions";
    file.why_no_markers = "it has no columns of type Marker and no rigid bodies";
    if (!names_.empty() || !bodies_.empty()) file.markers = TakeMarkers();
    file.notes = std::move(notes_);
    return file;
  }

 private:
  /// `Format Version,1.23,Take Name,...`: keys and values in turn.
  void ReadTakeLine() {
    lines_.Expect("the line Format Version");
    for (std::size_t i = 0; i + 1 < lines_.count(); i += 2) {
      take_.emplace(lines_.Name(i), lines_.Name(i + 1));
    }
    const auto rate = lines_.Parse(take_["Export Frame Rate"]);
    if (!rate || *rate <= 0.0) {
      lines_.Fail("Export Frame Rate: found " + Quote(take_["Export Frame Rate"]) +
                  "; frames per second, above 0, were expected");
    }
    rate_ = *rate;
    if (const std::string& space = take_["Coordinate Space"]; !space.empty() && space != "Global") {
      lines_.Fail("Coordinate Space: found " + Quote(space) + "; Global was expected");
    }
  }

  /// Rows Type, Name, ID and the like, then one of quantities, then Frame, Time and axes. Motive
  /// of format 1.21 (2016) does not say in the second column which row is which: types come first,
  /// then names.
  void ReadColumnRows() {
    std::vector<std::vector<std::string>> unnamed;
    bool named = false;
    for (;;) {
      lines_.Expect("the row Frame, Time (Seconds), X, Y, Z");
      if (lines_.blank()) continue;
      std::vector<std::string> cells;
      for (std::size_t i = 0; i < lines_.count(); ++i) cells.push_back(lines_.Name(i));
      if (cells.size() > columns_.size()) columns_.resize(cells.size());
      const bool frame = cells[0] == "Frame";
      const std::string key = cells.size() > 1 ? cells[1] : "";
      if (!frame && !cells[0].empty()) lines_.FailCell(0, "'Frame', or a row of the header,");
      for (std::size_t i = 2; i < cells.size(); ++i) {
        if (frame) columns_[i].axis = cells[i];
        if (key == "Type") columns_[i].type = cells[i];
        if (key == "Name") columns_[i].name = cells[i];
      }
      if (frame) {
        if (!key.starts_with("Time")) lines_.FailCell(1, "'Time (Seconds)'");
        TakeUnnamedRows(unnamed, named);
        return;
      }
      named = named || key == "Type";
      if (key.empty()) unnamed.push_back(std::move(cells));
    }
  }

  void TakeUnnamedRows(const std::vector<std::vector<std::string>>& rows, bool types_are_named) {
    if (rows.empty()) return;
    const auto take = [&](const std::vector<std::string>& row, std::string MotiveColumn::*cell) {
      for (std::size_t i = 2; i < row.size(); ++i) columns_[i].*cell = row[i];
    };
    take(rows.back(), &MotiveColumn::quantity);
    if (types_are_named || rows.size() < 3) return;
    take(rows[0], &MotiveColumn::type);
    take(rows[1], &MotiveColumn::name);
  }

  bool HasAxes(std::size_t i, std::string_view axes, std::string_view quantity) const {
    for (std::size_t k = 0; k < axes.size(); ++k) {
      if (i + k >= columns_.size()) return false;
      const MotiveColumn& column = columns_[i + k];
      if (column.axis != axes.substr(k, 1) || column.quantity != quantity ||
          column.name != columns_[i].name || column.type != columns_[i].type) {
        return false;
      }
    }
    return true;
  }

  void FindColumns() {
    std::map<std::string, MotiveBody> bodies;
    std::vector<std::string> order;
    std::size_t modelled = 0;
    for (std::size_t i = 2; i < columns_.size(); ++i) {
      const MotiveColumn& column = columns_[i];
      if (column.type == "Marker" && column.quantity == "Position" && column.axis == "X") {
        if (!HasAxes(i, "XYZ", "Position")) FailColumns(i);
        names_.push_back(column.name);
        markers_.push_back(i);
      }
      modelled += column.type == "Rigid Body Marker" && column.axis == "X" ? 1 : 0;
      if (column.type != "Rigid Body") continue;
      if (!bodies.contains(column.name)) order.push_back(column.name);
      MotiveBody& body = bodies[column.name];
      body.name = column.name;
      if (body.rotation == 0) FindRotation(i, body);
      if (HasAxes(i, "XYZ", "Position")) body.position = i;
    }
    for (const std::string& name : order) {
      const MotiveBody& body = bodies[name];
      if (body.position == 0 || body.rotation == 0) {
        notes_.push_back("the rigid body " + name + " is left out: it has no " +
                         (body.position == 0 ? "position" : "rotation"));
        continue;
      }
      bodies_.push_back(body);
    }
    if (modelled > 0) {
      notes_.push_back(std::to_string(modelled) +
                       " rigid body markers, which are of the model and not measured, are passed "
                       "over");
    }
  }

  /// Takes the rotation that begins in column i, if one does. Throws InputError if it is not of
  /// the take's rotation type.
  void FindRotation(std::size_t i, MotiveBody& body) {
    if (columns_[i].quantity != "Rotation") return;
    const std::string& type = take_["Rotation Type"];
    std::string sorted = type;
    std::sort(sorted.begin(), sorted.end());
    const bool angles = sorted == "XYZ";
    if (type != "Quaternion" && !angles) {
      throw InputError(Place(source_.name(), 1) + "Rotation Type: found " + Quote(type) + "; " +
                       std::string(kRotationTypes) + " was expected");
    }
    const bool fourth = HasAxes(i + 3, "W", "Rotation") && columns_[i + 3].name == body.name;
    for (const std::string& axes : {std::string("XYZ"), type}) {
      if (angles == fourth || !HasAxes(i, angles ? axes : "XYZW", "Rotation")) continue;
      body.rotation = i;
      body.axes = angles ? axes : "XYZW";
      return;
    }
    lines_.Fail("column " + std::to_string(i + 1) + ": the rotation of rigid body " +
                Quote(body.name) + " is not in the columns " + (angles ? "X, Y, Z" : "X, Y, Z, W") +
                " of Rotation Type " + type);
  }

  [[noreturn]] void FailColumns(std::size_t i) const {
    lines_.Fail("column " + std::to_string(i + 1) + ": the columns X, Y and Z of marker " +
                Quote(columns_[i].name) + " do not stand side by side");
  }

  void ReadFrames() {
    if (!names_.empty() || !bodies_.empty()) {
      unit_ = UnitOf(take_["Length Units"], options_.unit, source_.name());
    }
    Steps frames("Frame", 1.0, 0.0), times("Time (Seconds)", 1.0 / rate_, 0.5 / rate_);
    while (lines_.Next()) {
      if (lines_.blank()) continue;
      frames.Check(lines_, lines_.Number(0));
      times.Check(lines_, lines_.Number(1));
      for (const std::size_t column : markers_) AddMarker(column);
      for (const MotiveBody& body : bodies_) AddBody(body);
      ++count_;
    }
    if (count_ == 0) lines_.Fail("no frame below the header");
    const auto stated = lines_.Parse(take_["Total Exported Frames"]);
    if (stated && *stated != static_cast<double>(count_)) {
      lines_.Fail("found " + std::to_string(count_) + " frames; Total Exported Frames is " +
                  FormatNumber(*stated));
    }
    if (count_ > 1 && !lines_.blank() && EndsWithinALine(source_)) RemoveLastFrame();
  }

  void RemoveLastFrame() {
    rows_.RemoveLast(markers_.size());
    body_positions_.resize(body_positions_.size() - 3 * bodies_.size());
    body_rotations_.resize(body_rotations_.size() - 4 * bodies_.size());
    --count_;
    notes_.emplace_back(kCutRow);
  }

  void AddMarker(std::size_t column) {
    const auto [x, y, z] = lines_.Position(column);
    rows_.Add(unit_ * x, unit_ * y, unit_ * z);
  }

  void AddBody(const MotiveBody& body) {
    const auto position = lines_.Position(body.position);
    for (const double x : position) body_positions_.push_back(unit_ * x);
    if (body.axes == "XYZW") {
      for (std::size_t k = 0; k < 4; ++k) {
        body_rotations_.push_back(lines_.NumberOrGap(body.rotation + k));
      }
      return;
    }
    const auto cells = lines_.Position(body.rotation);
    Eigen::Vector3d angles;
    for (std::size_t k = 0; k < 3; ++k) angles[body.axes[k] - 'X'] = cells[k];
    const Eigen::Vector4d rotation = FromEulerAngles(take_["Rotation Type"], angles).coeffs();
    body_rotations_.insert(body_rotations_.end(), rotation.begin(), rotation.end());
  }

  MarkerTrajectories TakeMarkers() {
    MarkerTrajectories markers = rows_.Take(source_.name(), DistinctNames(names_), rate_);
    if (bodies_.empty()) return markers;
    BodyPoses poses;
    for (const MotiveBody& body : bodies_) poses.names.push_back(body.name);
    poses.positions = StackRows(body_positions_, count_);
    poses.rotations = StackRows(body_rotations_, count_);
    AddBodies(poses, markers, notes_);
    return markers;
  }

  const ByteSource& source_;
  const ReaderOptions& options_;
  CsvLines lines_;
  std::map<std::string, std::string> take_;
  std::vector<MotiveColumn> columns_;
  std::vector<std::string> names_;
  std::vector<std::size_t> markers_;
  std::vector<MotiveBody> bodies_;
  double rate_ = 0.0, unit_ = 0.0;
  std::size_t count_ = 0;
  MarkerRows rows_;
  std::vector<double> body_positions_, body_rotations_;
  std::vector<std::string> notes_;
};

}  // namespace

bool IsMotiveCsv(std::string_view head) {
  if (head.starts_with('"')) head.remove_prefix(1);
  return head.starts_with("Format Version");
}

RecordingFile ReadMotiveCsv(const ByteSource& source, const ReaderOptions& options) {
  return MotiveReader(source, options).Read();
}

}  // namespace elastocal
