// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/calibrated_robot.hpp"

#include <utility>

#include <nlohmann/json.hpp>

#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/report/json_reader.hpp"
#include "elastocal/report/run_record.hpp"
#include "elastocal/tables/read_file.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

/// The project file that the record of a calibration names first, as it was then.
fs::path RecordedProject(const fs::path& folder) {
  const fs::path file = folder / "runs.json";
  const std::string hint = "; name the project file by --project";
  std::error_code error;
  if (!fs::exists(file, error)) {
    throw InputError(file.string() + ": is not there: it says which project was calibrated" + hint);
  }
  const ordered_json runs = ParseJsonObject(file.string(), ReadFile(file));
  const auto run = runs.find("calibrate");
  const ordered_json none;
  const ordered_json& inputs =
      run != runs.end() && run->is_object() && run->contains("inputs") ? run->at("inputs") : none;
  const ordered_json& input = inputs.is_array() && !inputs.empty() ? inputs[0] : none;
  const auto text = [&](const char* key) {
    const bool there = input.is_object() && input.contains(key) && input[key].is_string();
    return there ? input[key].get<std::string>() : std::string();
  };
  const fs::path project = text("file");
  if (project.empty()) throw InputError(file.string() + ": no inputs of calibrate" + hint);
  if (!fs::exists(project, error)) {
    throw InputError(file.string() + ": the project " + project.string() + " is not there" + hint);
  }
  const std::vector<InputRecord> now = RecordInputs({project});
  if (now.empty() || text("sha256") != now.front().sha256) {
    throw InputError(project.string() + ": has changed since the calibration" + hint);
  }
  return project;
}

fs::path FolderOf(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
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
  const ordered_json runs = ParseJsonObject(file.string(), ReadFile(file));
  std::vector<fs::path> recordings;
  const ordered_json inputs =
      runs.value("calibrate", ordered_json::object()).value("inputs", ordered_json::array());
  for (std::size_t i = 2; i < inputs.size(); ++i) {
    const fs::path input = inputs[i].value("file", std::string());
    if (input.filename() == "experiment.yaml") recordings.push_back(input.parent_path());
  }
  if (recordings.empty() && inputs.size() > 2) {
    recordings.emplace_back(inputs[2].value("file", std::string()));
  }
  if (recordings.empty() || recordings.front().empty()) {
    throw InputError(file.string() +
                     ": names no recording of calibrate; expected a folder that "
                     "calibrate -o wrote to");
  }
  std::error_code error;
  for (const fs::path& recording : recordings) {
    if (fs::exists(recording, error)) continue;
    throw InputError(file.string() + ": the recording " + recording.string() + " is not there");
  }
  return recordings;
}

}  // namespace elastocal
