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

}  // namespace

CalibratedRobot OpenCalibratedRobot(const fs::path& given, const fs::path& project) {
  const fs::path file = FindCalibrationFiles(given).calibration;
  StoredCalibration calibration = ReadCalibration(file);
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const fs::path project_file = project.empty() ? RecordedProject(folder) : project;
  CalibratedRobot robot{ReadProject(project_file), std::move(calibration), {}};
  robot.inputs = {project_file, robot.project.urdf, file};
  return robot;
}

}  // namespace elastocal
