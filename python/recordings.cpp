// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "bindings.hpp"
#include "elastocal/io/posture_table.hpp"
#include "elastocal/io/recorded_files.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/pipeline/recording_info.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal::python {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

py::dict ToDict(const MarkerTrajectories& markers, const RecordingFile& file) {
  const auto frames = static_cast<py::ssize_t>(markers.frame_count());
  const auto count = static_cast<py::ssize_t>(markers.marker_count());
  py::array_t<double> positions({frames, count, py::ssize_t{3}});
  Eigen::Map<RowMajor>(positions.mutable_data(), frames, 3 * count) = markers.positions;
  py::dict result;
  result["names"] = markers.names;
  result["rate_hz"] = markers.rate_hz;
  result["positions"] = positions;
  result["up"] = file.up.empty() ? py::object(py::none()) : py::object(py::str(file.up));
  return result;
}

/// Contents of the file, under its own names.
py::dict Read(const Path& path, const std::string& unit, const std::string& topic,
              const std::string& tf_frame, const Names& tf_bodies, bool salvage,
              const std::string& time_unit) {
  const ReaderOptions options{unit, time_unit, topic, tf_frame, tf_bodies, salvage};
  RecordingFile file = Unlocked([&] { return ReadAnyRecording(path, options); });
  if (file.postures && !file.postures->columns.empty()) {
    throw InputError(path.string() + ": this is no recording: " + file.why_no_joints);
  }
  if (file.postures) {
    throw InputError(path.string() +
                     ": this is a posture table (info tells of it); a recording of cameras or a "
                     "robot over time was expected");
  }
  py::dict result;
  result["format"] = file.format;
  result["markers"] = py::none();
  result["joints"] = py::none();
  if (file.markers) result["markers"] = ToDict(*file.markers, file);
  if (file.joints) {
    py::dict joints;
    joints["names"] = file.joints->names;
    joints["time_s"] = std::move(file.joints->time_s);
    joints["positions"] = std::move(file.joints->positions);
    joints["torques"] = std::move(file.joints->torques);
    result["joints"] = joints;
  }
  result["notes"] = file.notes;
  return result;
}

py::object Info(const Path& file, const std::string& unit, const std::string& topic,
                const std::string& tf_frame, const Names& tf_bodies, bool salvage,
                const std::string& time_unit) {
  constexpr int kPictureColumns = 48;
  return FromJson(Unlocked([&] {
    return MakeInfoJson(DescribeRecording(
        file.string(), {unit, time_unit, topic, tf_frame, tf_bodies, salvage}, kPictureColumns));
  }));
}

using Cube = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Throws InputError for positions that no reader would accept.
void ExpectPositions(const Recording& recording, const Names& joints) {
  for (Eigen::Index i = 0; i < recording.q.rows(); ++i) {
    for (Eigen::Index c = 0; c < recording.q.cols(); ++c) {
      if (std::isfinite(recording.q(i, c))) continue;
      throw InputError("positions: " + FormatNumber(recording.q(i, c)) + " of joint " +
                       Quote(joints[Size(c)]) + " in posture " + std::to_string(i) +
                       "; a number was expected, because the table has a row for each posture");
    }
    for (Eigen::Index m = 0; 3 * m < recording.markers.cols(); ++m) {
      const Eigen::Vector3d at = recording.markers.row(i).segment<3>(3 * m).transpose();
      if (at.allFinite() || at.array().isNaN().all()) continue;
      throw InputError("markers: " + Quote(recording.marker_names[Size(m)]) + " in posture " +
                       std::to_string(i) +
                       "; three numbers were expected or, where it was not seen, three NaN");
    }
  }
}

void WriteTable(const ProjectOrFile& project_or_file, const Path& file, const RowMajor& positions,
                const Cube& markers, const std::optional<Names>& marker_names) {
  const Project& project = project_or_file.project;
  Recording recording;
  recording.q = positions;
  if (marker_names) {
    recording.marker_names = *marker_names;
  } else {
    for (const Marker& marker : project.markers) recording.marker_names.push_back(marker.name);
  }
  const auto postures = static_cast<py::ssize_t>(positions.rows());
  const auto count = static_cast<py::ssize_t>(recording.marker_names.size());
  if (positions.cols() != project.tree.coordinate_count()) {
    throw InputError("positions: " + std::to_string(positions.cols()) + " columns; " +
                     std::to_string(project.tree.coordinate_count()) +
                     " were expected, one a joint of the project");
  }
  if (markers.ndim() != 3 || markers.shape(0) != postures || markers.shape(1) != count ||
      markers.shape(2) != 3) {
    throw InputError("markers: an array of (" + std::to_string(postures) + ", " +
                     std::to_string(count) + ", 3) was expected");
  }
  recording.markers = Eigen::Map<const RowMajor>(markers.data(), postures, 3 * count);
  ExpectPositions(recording, CoordinateNames(project.tree));
  WritePostureTable(file, recording, project);
}

}  // namespace

void AddRecordings(py::module_& module) {
  module.def("read", Read, "file"_a, py::kw_only(), "unit"_a = "", "topic"_a = "",
             "tf_frame"_a = "", "tf_bodies"_a = Names(), "salvage"_a = false, "time_unit"_a = "",
             "Reads a recording of any format: 'markers' with positions (frames, markers, 3) in m, "
             "NaN where not seen, and 'joints' with time_s (samples), positions (samples, joints), "
             "rad or m, and torques (samples, joints), N.m or N. unit: of lengths, where the file "
             "does not say it ('mm'). topic: of the joints, in a bag with several. tf_frame: the "
             "cameras' frame in the tf of a bag; tf_bodies: frames that are bodies, by default all "
             "that move in it. salvage: reads a bag that was not closed or was cut off, up to "
             "where it ends, which 'notes' then say. time_unit: of a joint log that does not state "
             "it ('ns'; by default s).");
  module.def("info", Info, "file"_a, py::kw_only(), "unit"_a = "", "topic"_a = "",
             "tf_frame"_a = "", "tf_bodies"_a = Names(), "salvage"_a = false, "time_unit"_a = "",
             "What is in a recording or a posture table: the dict of `elastocal info --json`.");
  module.def("write_table", WriteTable, "project"_a, "file"_a, "positions"_a, "markers"_a,
             py::kw_only(), "marker_names"_a = std::nullopt,
             "Writes a table of static postures (CSV) that calibrate() and the program read. "
             "positions: (postures, joints), rad or m, by Project.joints. markers: (postures, "
             "markers, 3), m, NaN where not seen, by Project.markers unless `marker_names` names "
             "them. Columns have the project's names (`recording.columns` of docs/formats.md).");
}

}  // namespace elastocal::python
