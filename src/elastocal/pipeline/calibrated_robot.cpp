// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/calibrated_robot.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/report/json_reader.hpp"
#include "elastocal/tables/read_file.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

fs::path FolderOf(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// An input of `calibrate` as named in runs.json.
struct RecordedInput {
  fs::path file;  ///< relative to the working directory
  std::string sha256;
};

ordered_json Member(const ordered_json& json, const char* key) {
  return json.is_object() && json.contains(key) ? json.at(key) : ordered_json::object();
}

std::string TextOf(const ordered_json& json, const char* key) {
  const ordered_json value = Member(json, key);
  return value.is_string() ? value.get<std::string>() : std::string();
}

/// The record of `calibrate`; an empty object where there is none.
ordered_json RecordedRun(const fs::path& runs) {
  return Member(ParseJsonObject(runs.string(), ReadFile(runs)), "calibrate");
}

/// Path of a file that a record names; relative names start in the folder where calibrate was run.
fs::path FileOf(const ordered_json& run, const fs::path& file) {
  std::error_code error;
  const fs::path there = TextOf(run, "folder") / file;
  return file.is_relative() && !file.empty() && fs::exists(there, error) ? there : file;
}

/// The inputs of a calibration: project, URDF, then recordings. Empty where the record names none.
std::vector<RecordedInput> RecordedInputs(const fs::path& runs) {
  const ordered_json run = RecordedRun(runs);
  std::vector<RecordedInput> inputs;
  const ordered_json list = Member(run, "inputs");
  for (const ordered_json& input : list) {
    inputs.push_back({FileOf(run, TextOf(input, "file")), TextOf(input, "sha256")});
  }
  return inputs;
}

bool HasChanged(const RecordedInput& input) {
  const std::vector<InputRecord> now = RecordInputs({input.file});
  return now.empty() || input.sha256 != now.front().sha256;
}

/// Path of the project file that the record of a calibration names first.
fs::path RecordedProject(const fs::path& folder) {
  const fs::path file = folder / "runs.json";
  const std::string hint = "; name the project file (--project; in Python, project=)";
  std::error_code error;
  if (!fs::exists(file, error)) {
    throw InputError(file.string() + ": is not there: it says which project was calibrated" + hint);
  }
  const std::vector<RecordedInput> inputs = RecordedInputs(file);
  if (inputs.empty() || inputs.front().file.empty()) {
    throw InputError(file.string() + ": no inputs of calibrate" + hint);
  }
  const fs::path& project = inputs.front().file;
  if (!fs::exists(project, error)) {
    throw InputError(file.string() + ": the project " + project.string() + " is not there" + hint);
  }
  if (HasChanged(inputs.front())) {
    throw InputError(project.string() + ": has changed since the calibration" + hint);
  }
  return project;
}

}  // namespace

CalibratedRobot OpenCalibratedRobot(const fs::path& given, const fs::path& project) {
  const fs::path file = FindCalibrationFiles(given).calibration;
  StoredCalibration calibration = ReadCalibration(file);
  const fs::path project_file = project.empty() ? RecordedProject(FolderOf(file)) : project;
  CalibratedRobot robot{ReadProject(project_file), std::move(calibration), {}};
  robot.inputs = {project_file, robot.project.urdf, file};
  return robot;
}

std::vector<fs::path> RecordedRecordings(const CalibratedRobot& robot) {
  const fs::path file = FolderOf(robot.calibration.source) / "runs.json";
  const std::vector<RecordedInput> inputs = RecordedInputs(file);
  std::vector<fs::path> recordings;
  for (std::size_t i = 2; i < inputs.size(); ++i) {
    const fs::path& input = inputs[i].file;
    if (robot.project.contact) {
      if (input.extension() == ".yaml") break;  // what `--prior` names follows the tables
      recordings.push_back(input);
    } else if (input.filename() == "experiment.yaml") {
      recordings.push_back(input.parent_path());
    }
  }
  if (recordings.empty() && inputs.size() > 2) recordings.push_back(inputs[2].file);
  if (recordings.empty() || recordings.front().empty()) {
    throw InputError(file.string() +
                     ": names no recording of calibrate; expected a folder that "
                     "calibrate -o wrote to");
  }
  std::error_code error;
  for (std::size_t i = 2; i < inputs.size(); ++i) {
    const std::string name = inputs[i].file.string();
    if (!fs::exists(inputs[i].file, error)) {
      throw InputError(file.string() + ": the recording " + name + " is not there");
    }
    if (HasChanged(inputs[i])) throw InputError(name + ": has changed since the calibration");
  }
  return recordings;
}

Assumptions RecordedAssumptions(const CalibratedRobot& robot) {
  const ordered_json run = RecordedRun(FolderOf(robot.calibration.source) / "runs.json");
  Assumptions told;
  const ordered_json accept = Member(run, "accept"), days = Member(run, "days");
  for (const ordered_json& name : accept) {
    if (name.is_string()) told.accept.push_back(name.get<std::string>());
  }
  told.prior = FileOf(run, TextOf(run, "prior")).string();
  if (days.is_number()) told.days = days.get<double>();
  told.marker_places = FileOf(run, TextOf(run, "marker_places")).string();
  return told;
}

std::vector<fs::path> RecordedFiles(const CalibratedRobot& robot) {
  std::vector<fs::path> files;
  try {
    const fs::path record = FolderOf(robot.calibration.source) / "runs.json";
    for (RecordedInput& input : RecordedInputs(record)) files.push_back(std::move(input.file));
  } catch (const InputError&) {
    return {};  // the calibration was read without its record, by --project
  }
  return files;
}

bool IsOwnRecording(const fs::path& calibration, const std::vector<fs::path>& files) {
  const fs::path record = FolderOf(calibration) / "runs.json";
  std::error_code error;
  if (!fs::exists(record, error)) return false;
  std::set<std::string> used;
  const std::vector<RecordedInput> inputs = RecordedInputs(record);
  for (std::size_t i = 2; i < inputs.size(); ++i) {  // after project and URDF
    if (inputs[i].file.filename() != "experiment.yaml") used.insert(inputs[i].sha256);
  }
  const std::vector<InputRecord> now = RecordInputs(files);
  return std::any_of(now.begin(), now.end(),
                     [&](const InputRecord& file) { return used.contains(file.sha256); });
}

bool WarnOfOwnRecording(const fs::path& calibration, const std::vector<fs::path>& files,
                        std::vector<std::string>& warnings) {
  if (!IsOwnRecording(calibration, files)) return false;
  warnings.emplace_back(
      "the calibration was made from this recording: it says nothing of another day; take another "
      "recording");
  return true;
}

}  // namespace elastocal
