// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/recording_info.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <string_view>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "elastocal/io/joint_log.hpp"
#include "elastocal/io/recorded_files.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/gaps.hpp"
#include "elastocal/readers/qtm_tsv.hpp"
#include "elastocal/tables/json_text.hpp"
#include "elastocal/tables/table_reader.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

/// The line by which a TSV is recognised as converted; QTM itself writes such lines.
constexpr const char* kDescription = "DESCRIPTION\tWritten by elastocal convert\r\n";

/// Whether every number of a line has the shortest digits, as TableWriter writes them.
bool HasShortestDigits(std::string line) {
  std::vector<std::string_view> cells;
  if (!SplitCells(line, ',', Quotes::kEnclose, cells)) return false;
  return std::all_of(cells.begin(), cells.end(), [](std::string_view cell) {
    const std::optional<double> number = ParseNumber(cell);
    return number ? cell == FormatNumber(*number) : cell.empty();
  });
}

MarkerSight LookAt(const MarkerTrajectories& markers, int marker, int parts) {
  MarkerSight sight;
  sight.name = markers.names[static_cast<std::size_t>(marker)];
  const int frames = markers.frame_count();
  std::vector<int> seen(static_cast<std::size_t>(parts)), all(seen);
  int total = 0, last = -1;
  for (int frame = 0; frame < frames; ++frame) {
    const auto part = static_cast<std::size_t>(static_cast<std::int64_t>(frame) * parts / frames);
    ++all[part];
    if (!Seen(markers, frame, marker)) continue;
    ++seen[part];
    ++total;
    if (last >= 0 && frame > last + 1) {
      ++sight.gaps;
      sight.longest_gap_s = std::max(sight.longest_gap_s, (frame - last - 1) / markers.rate_hz);
    }
    last = frame;
  }
  sight.seen_share = frames > 0 ? static_cast<double>(total) / frames : 0.0;
  for (std::size_t part = 0; part < seen.size(); ++part) {
    if (all[part] > 0) sight.share_by_part.push_back(static_cast<double>(seen[part]) / all[part]);
  }
  return sight;
}

void LookAtLog(const JointLog& log, RecordingInfo& info) {
  std::vector<double> intervals;
  for (Eigen::Index i = 1; i < log.time_s.size(); ++i) {
    intervals.push_back(log.time_s[i] - log.time_s[i - 1]);
  }
  if (!intervals.empty()) {
    info.longest_hole_s = *std::max_element(intervals.begin(), intervals.end());
    const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
    std::nth_element(intervals.begin(), middle, intervals.end());
    info.log_rate_hz = 1.0 / *middle;
  }
  for (Eigen::Index k = 0; k < log.torques.cols(); ++k) {
    info.torques += log.torques.col(k).array().isNaN().all() ? 0 : 1;
  }
}

/// Rotates positions so that the axis `up` becomes z: coordinates change places and signs.
void TurnUp(const std::string& up, Eigen::MatrixXd& positions) {
  for (Eigen::Index column = 0; column < positions.cols(); column += 3) {
    const Eigen::VectorXd x = positions.col(column), y = positions.col(column + 1),
                          z = positions.col(column + 2);
    const auto set = [&](const Eigen::VectorXd& a, const Eigen::VectorXd& b,
                         const Eigen::VectorXd& c) {
      positions.col(column) = a;
      positions.col(column + 1) = b;
      positions.col(column + 2) = c;
    };
    if (up == "x") set(-z, y, x);
    if (up == "-x") set(z, y, -x);
    if (up == "y") set(x, -z, y);
    if (up == "-y") set(x, z, -y);
    if (up == "-z") set(x, -y, -z);
  }
}

std::string ConvertMarkers(RecordingFile& file, const std::string& up) {
  MarkerTrajectories& markers = *file.markers;
  const bool custom = file.format == "Qualisys TSV";
  if (!up.empty() && !file.up.empty() && up != file.up && !custom) {
    throw InputError(markers.source + ": by this file the axis " + file.up + " points up, not " +
                     up);
  }
  const std::string axis = up.empty() ? file.up : up;
  if (axis.empty()) {
    throw InputError(markers.source +
                     ": the file does not say which axis of the cameras' frame points up; give it "
                     "by --up (x, y, z, -x, -y or -z)");
  }
  TurnUp(axis, markers.positions);
  constexpr int kDecimals = 6;
  std::string text = FormatQtmTsv(markers, kDecimals);
  return text.insert(text.find("DATA_INCLUDED"), kDescription);
}

/// A reader's option, and the formats on which it has an effect.
struct IdleCheck {
  bool given;
  const char* option;
  const char* needs;  ///< in words
  std::vector<std::string> formats;
};

/// Throws InputError for an option that would do nothing with a file of this format.
void RefuseIdleOptions(const std::string& path, const std::string& format,
                       const ReaderOptions& options) {
  const std::vector<std::string> bags = {"MCAP", "ROS 1 bag", "ROS 2 bag (db3)"};
  const std::vector<std::string> timed = {"NumPy .npz", "joint log (CSV)"};
  const std::vector<std::string> measured = {"C3D", "Vicon Nexus CSV", "OptiTrack Motive CSV",
                                             "TRC"};
  const std::vector<IdleCheck> checks = {
      {!options.joints_topic.empty(), "--topic", "bags", bags},
      {!options.tf_frame.empty(), "--tf-frame", "bags", bags},
      {!options.tf_bodies.empty(), "--tf-bodies", "bags", bags},
      {options.salvage, "--salvage", "bags", bags},
      {!options.time_unit.empty(), "--time-unit", "joint logs (CSV or .npz)", timed},
      {!options.unit.empty(), "--unit", "C3D, TRC and the CSV of Vicon and Motive", measured}};
  for (const IdleCheck& check : checks) {
    if (!check.given || std::ranges::find(check.formats, format) != check.formats.end()) continue;
    throw InputError(path + " (" + format + "): " + check.option + " is for " + check.needs +
                     "; it would do nothing here");
  }
}

/// The only part of a file. Throws InputError where it has both or none.
RecordingPart OnlyPart(const std::string& path, const RecordingFile& file) {
  if (file.markers && file.joints) {
    throw InputError(path +
                     ": has markers and joints; say which by --part markers or --part joints");
  }
  if (!file.markers && !file.joints) {
    throw InputError(path + " (" + file.format + "): there are no markers in it: " +
                     file.why_no_markers + "; nor joint positions: " + file.why_no_joints);
  }
  return file.joints ? RecordingPart::kJoints : RecordingPart::kMarkers;
}

ConvertedRecording ConvertJoints(JointLog& log) {
  ConvertedRecording converted;
  for (Eigen::Index k = 0; k < log.torques.cols(); ++k) {
    const Eigen::Index missing = log.torques.col(k).array().isNaN().count();
    if (missing == 0 || missing == log.torques.rows()) continue;
    log.torques.col(k).setConstant(kNaN);
    converted.warnings.push_back("joint " + log.names[static_cast<std::size_t>(k)] + ": " +
                                 std::to_string(missing) +
                                 " samples have no torque; its torques are left out");
  }
  converted.text = FormatJointLog(log);
  return converted;
}

}  // namespace

RecordingInfo DescribeRecording(const std::string& file, const ReaderOptions& options, int parts) {
  RecordingInfo info;
  info.file = ReadAnyRecording(file, options);
  RefuseIdleOptions(file, info.file.format, options);
  if (info.file.markers) {
    for (int m = 0; m < info.file.markers->marker_count(); ++m) {
      info.sights.push_back(LookAt(*info.file.markers, m, parts));
    }
  }
  if (info.file.joints) LookAtLog(*info.file.joints, info);
  return info;
}

std::string MakeInfoJson(const RecordingInfo& info) {
  Json json = {{"format", info.file.format}, {"markers", nullptr}, {"joints", nullptr}};
  if (const auto& markers = info.file.markers) {
    Json list = Json::array();
    for (const MarkerSight& sight : info.sights) {
      list.push_back({{"name", sight.name},
                      {"seen_share", sight.seen_share},
                      {"gaps", sight.gaps},
                      {"longest_gap_s", sight.longest_gap_s},
                      {"share_by_part", sight.share_by_part}});
    }
    json["markers"] = {{"frames", markers->frame_count()},
                       {"rate_hz", markers->rate_hz},
                       {"up", info.file.up.empty() ? Json() : Json(info.file.up)},
                       {"list", list}};
  }
  if (const auto& log = info.file.joints) {
    const bool any = log->sample_count() > 0;
    json["joints"] = {{"names", log->names},
                      {"samples", log->sample_count()},
                      {"begin_s", any ? Json(log->time_s[0]) : Json()},
                      {"end_s", any ? Json(log->time_s[log->time_s.size() - 1]) : Json()},
                      {"rate_hz", info.log_rate_hz},
                      {"longest_hole_s", info.longest_hole_s},
                      {"with_torque", info.torques}};
  }
  json["postures"] = nullptr;
  if (const auto& postures = info.file.postures) {
    Json list = Json::array();
    for (const NamedPostures::Sight& sight : postures->markers) {
      list.push_back({{"name", sight.marker}, {"seen", sight.seen}});
    }
    json["postures"] = {
        {"count", postures->count}, {"markers", list}, {"joints", postures->joints}};
    for (const NamedPostures::Column& column : postures->columns) {
      const bool numbers = column.numbers == column.filled && column.filled > 0;
      json["postures"]["columns"].push_back({{"name", column.name},
                                             {"filled", column.filled},
                                             {"least", numbers ? Json(column.least) : Json()},
                                             {"largest", numbers ? Json(column.largest) : Json()}});
    }
  }
  json["notes"] = info.file.notes;
  return JsonText(json);
}

ConvertedRecording ConvertRecording(const std::string& path, const ReaderOptions& options,
                                    RecordingPart part, const std::string& up) {
  RecordingFile file = ReadAnyRecording(path, options);
  if (file.postures && !file.postures->columns.empty()) {
    throw InputError(
        path + ": this is no recording of a known format, nor a joint log: " + file.why_no_joints +
        " (`calibrate` reads tables of postures, observations and detections with "
        "their project)");
  }
  if (file.postures) {
    throw InputError(path +
                     ": this is a posture table, which calibrate takes as it is; a recording of "
                     "cameras or a robot over time was expected");
  }
  RefuseIdleOptions(path, file.format, options);
  if (part == RecordingPart::kOnlyOne) part = OnlyPart(path, file);
  if (part == RecordingPart::kMarkers) {
    if (file.markers) {
      ConvertedRecording converted{ConvertMarkers(file, up), file.salvaged};
      if (file.joints && file.markers_start_s) {
        converted.warnings.push_back(
            "the file begins at 0 and not on the clock of the bag; beside the bag's joint log, "
            "experiment.yaml needs expected_lag_s: " +
            FormatNumber(-*file.markers_start_s));
      }
      return converted;
    }
    throw InputError(path + " (" + file.format +
                     "): there are no markers in it: " + file.why_no_markers);
  }
  if (file.joints) {
    if (!up.empty()) throw InputError(path + ": --up is for markers; it would do nothing here");
    ConvertedRecording converted = ConvertJoints(*file.joints);
    converted.warnings.insert(converted.warnings.begin(), file.salvaged.begin(),
                              file.salvaged.end());
    return converted;
  }
  throw InputError(path + " (" + file.format +
                   "): there are no joint positions in it: " + file.why_no_joints);
}

bool IsConverted(const std::string& text, const ConvertedRecording& converted) {
  if (text.find(kDescription) != std::string::npos) return true;
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  if (line != converted.text.substr(0, converted.text.find('\n'))) return false;
  while (std::getline(lines, line)) {
    if (!HasShortestDigits(line)) return false;
  }
  return true;
}

}  // namespace elastocal
