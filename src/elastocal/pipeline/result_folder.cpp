// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/result_folder.hpp"

#include <optional>
#include <set>
#include <sstream>

#include "elastocal/description/move_urdf.hpp"
#include "elastocal/files/output_files.hpp"
#include "elastocal/io/calibration_file.hpp"
#include "elastocal/io/covariance_file.hpp"
#include "elastocal/io/fingerprint.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/checksums.hpp"
#include "elastocal/pipeline/robot_views.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/report/json_reader.hpp"
#include "elastocal/report/page.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRuns = "runs.json";
constexpr const char* kPage = "report.html";
constexpr const char* kProject = "project.yaml";  // written by init

/// The files of a folder after the publication of `outputs` (null: as they are now).
class FolderAfter {
 public:
  FolderAfter(const fs::path& folder, const OutputSet* outputs)
      : folder_(folder), outputs_(outputs) {}

  bool IsChanging() const { return outputs_ != nullptr; }

  /// Contents of a file; nothing where it does not exist.
  std::optional<std::string> Text(const std::string& name) const {
    const fs::path file = folder_ / name;
    if (outputs_ != nullptr && outputs_->IsDeclared(file)) {
      const std::string* contents = outputs_->Contents(file);
      return contents == nullptr ? std::nullopt : std::optional(*contents);
    }
    std::error_code error;
    if (!fs::is_regular_file(file, error)) return std::nullopt;
    return ReadFile(file);
  }

 private:
  const fs::path& folder_;
  const OutputSet* outputs_;
};

void CheckFolder(const fs::path& folder) {
  if (folder.empty()) throw InputError("the name of a folder is empty");
  if (FileTypeOf(folder) != fs::file_type::directory) {
    throw InputError(folder.string() + ": is no folder; expected one that calibrate -o wrote to");
  }
}

std::set<std::string> RegularFiles(const fs::path& folder) {
  std::set<std::string> names;
  std::error_code error, ignored;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->is_regular_file(ignored)) names.insert(entry->path().filename().string());
  }
  if (error) throw InputError(folder.string() + ": cannot be read: " + error.message());
  return names;
}

/// The records so far. Empty where there are none, or where they cannot be read, which is no reason
/// to lose a result.
std::string EarlierRuns(const fs::path& folder) {
  try {
    return FolderAfter(folder, nullptr).Text(kRuns).value_or("");
  } catch (const InputError&) {
    return "";
  }
}

/// The calibration in a folder; nothing where there is none.
std::optional<LabelledCalibration> CalibrationOf(const fs::path& folder, const FolderAfter& after) {
  const auto text = after.Text("calibration.yaml");
  if (!text) return std::nullopt;
  LabelledCalibration calibration{folder.lexically_normal().string(),
                                  ParseEstimate(*text, (folder / "calibration.yaml").string())};
  if (const auto table = after.Text("covariance.csv")) {
    std::istringstream stream(*table);
    ReadCovariance(stream, (folder / "covariance.csv").string(), calibration.estimate);
  }
  return calibration;
}

/// Removes sources that refer to another calibration than the folder's.
void RemoveOutdated(const std::string& calibration, ReportSources& sources) {
  for (const char* name : {"deployment.json", "diagnosis.json", "validation.json"}) {
    const auto file = sources.files.find(name);
    if (file == sources.files.end()) continue;
    const auto json = ParseJsonObject((fs::path(sources.folder) / name).string(), file->second);
    const auto of = json.find("calibration_fingerprint");
    if (of == json.end() || *of == CalibrationFingerprint(calibration)) continue;
    sources.outdated.emplace_back(name);
    sources.files.erase(file);
  }
}

/// The page of a folder that will have files of these names.
std::string MakePageOf(const fs::path& folder, const std::set<std::string>& names,
                       const FolderAfter& after, const std::string& version,
                       const std::vector<fs::path>& earlier) {
  ReportSources sources{folder.lexically_normal().string(), version, {}, {}, {}};
  for (const std::string& name : ReportFiles({names.begin(), names.end()})) {
    if (auto text = after.Text(name)) sources.files[name] = std::move(*text);
  }
  if (names.contains(kProject) && !after.IsChanging() && !sources.files.contains("summary.json") &&
      !sources.files.contains("validation.json")) {
    std::vector<std::string> warnings;  // the view shows that a mesh is missing
    sources.files["robot_data.json"] =
        MakeRobotDataJson(MakeRobotView(ReadProject(folder / kProject), warnings));
  }
  if (sources.files.empty()) {
    throw InputError(folder.string() +
                     ": nothing to report in this folder; expected summary.json of calibrate -o, "
                     "or what init, design or plan write");
  }
  if (const auto calibration = after.Text("calibration.yaml")) {
    RemoveOutdated(*calibration, sources);
  }
  for (const fs::path& given : earlier) {
    sources.calibrations.push_back(
        {given.lexically_normal().string(), ReadCalibrationFiles(FindCalibrationFiles(given))});
  }
  if (auto own = CalibrationOf(folder, after)) {
    for (const LabelledCalibration& other : sources.calibrations) {
      if (other.estimate.nominal == own->estimate.nominal) continue;
      throw InputError(other.estimate.source + ": is of robot '" + other.estimate.robot +
                       "', whose nominal geometry is not that of " + own->estimate.source + " ('" +
                       own->estimate.robot +
                       "'); an earlier calibration of the same robot was expected");
    }
    sources.calibrations.push_back(std::move(*own));
  }
  return MakePage(PageTemplate(), MakeReportJson(sources));
}

/// The text of a result. A calibrated URDF is the user's, from another folder.
std::string InFolder(const fs::path& folder, const std::string& name, const std::string& contents,
                     const RunRecord& record) {
  for (const InputRecord& input : record.inputs) {
    const fs::path urdf = fs::path(record.folder) / input.file;
    if (urdf.extension() != ".urdf" || CalibratedUrdfName(urdf) != name) continue;
    return MoveUrdf(contents, (folder / name).string(), urdf.parent_path(), folder);
  }
  return contents;
}

}  // namespace

const char* const kNoPage =
    "no report.html: this program was built without Node.js, so it lacks the page; install nodejs "
    "and npm, then configure and build again";

void DeclareResults(const fs::path& folder, const std::vector<std::string>& names,
                    OutputSet& outputs) {
  std::vector<std::string> all = names;
  all.insert(all.end(), {kRuns, kPage, kChecksums});
  RecoverOutputs(folder);
  CheckOwn(folder, {all.begin(), all.end() - 1});
  for (const std::string& name : all) outputs.Declare(folder / name);
}

std::string SetResults(const fs::path& folder, const std::map<std::string, std::string>& files,
                       const RunRecord& record, OutputSet& outputs) {
  std::set<std::string> names = RegularFiles(folder);
  for (const auto& [name, contents] : files) {
    outputs.Set(folder / name, InFolder(folder, name, contents, record));
    names.insert(name);
  }
  outputs.Set(folder / kRuns, UpdateRuns(EarlierRuns(folder), record));
  names.insert(kRuns);
  std::string why_no_page;
  if (PageTemplate().empty()) {
    why_no_page = kNoPage;
  } else {
    try {
      outputs.Set(folder / kPage,
                  MakePageOf(folder, names, FolderAfter(folder, &outputs), record.version, {}));
    } catch (const InputError& error) {
      // The results themselves are valid: something else in the folder cannot be shown.
      why_no_page = std::string("no report.html: ") + error.what();
    }
  }
  outputs.Set(folder / kChecksums, UpdateChecksums(folder, outputs));
  return why_no_page;
}

void DeclarePage(const fs::path& folder, const fs::path& page, OutputSet& outputs) {
  outputs.Declare(page, "<!doctype html>");
  if (!outputs.DeclaredIn(folder).empty()) outputs.Declare(folder / kChecksums);
}

void SetPage(const fs::path& folder, const fs::path& page, std::string contents,
             OutputSet& outputs) {
  outputs.Set(page, std::move(contents));
  if (!outputs.IsDeclared(folder / kChecksums)) return;
  outputs.Set(folder / kChecksums, UpdateChecksums(folder, outputs));
}

void DeclareJson(const fs::path& file, OutputSet& outputs) {
  outputs.Declare(file, "{");
  if (file.empty() || file == "-") return;
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const std::string name = file.filename().string();
  const bool own_run = outputs.IsDeclared(folder / kChecksums) && ReportFiles({name}).empty();
  if (ListedIn(folder, name) && !own_run) {
    throw InputError(file.string() + ": is a result that " + kChecksums +
                     " lists, so it is not replaced; choose another name");
  }
}

std::string MakeFolderPage(const fs::path& folder, const std::string& version,
                           const std::vector<fs::path>& earlier) {
  CheckFolder(folder);
  CheckChecksums(folder);
  return MakePageOf(folder, RegularFiles(folder), FolderAfter(folder, nullptr), version, earlier);
}

std::vector<fs::path> PageInputs(const fs::path& folder, const std::vector<fs::path>& earlier) {
  CheckFolder(folder);
  const std::set<std::string> names = RegularFiles(folder);
  std::vector<fs::path> inputs = {folder / "calibration.yaml", folder / "covariance.csv"};
  for (const std::string& name : ReportFiles({names.begin(), names.end()})) {
    inputs.push_back(folder / name);
  }
  for (const fs::path& given : earlier) {
    const CalibrationFiles files = FindCalibrationFiles(given);
    inputs.insert(inputs.end(), {files.calibration, files.covariance});
  }
  return inputs;
}

}  // namespace elastocal
