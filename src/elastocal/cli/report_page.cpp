#include "elastocal/cli/report_page.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "elastocal/cli/error_table_report.hpp"
#include "elastocal/io/calibration_file.hpp"
#include "elastocal/io/covariance_file.hpp"
#include "elastocal/io/experiment.hpp"
#include "elastocal/io/output_files.hpp"
#include "elastocal/io/recording_folder.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/report/calibration_view.hpp"
#include "elastocal/report/page.hpp"

namespace elastocal::cli {
namespace {

namespace fs = std::filesystem;

std::vector<std::string>& CommandLine() {
  static std::vector<std::string> words;
  return words;
}

/// The joints between the ends of a chain that move, by name.
ChainView ViewOf(const Chain& chain, const RobotTree& tree) {
  ChainView view{chain.name, {}};
  const std::vector<int> below = JointsToBody(tree, tree.links[chain.from_link].body);
  for (const int joint : JointsToBody(tree, tree.links[chain.tip_link].body)) {
    if (std::find(below.begin(), below.end(), joint) == below.end()) {
      view.joints.push_back(tree.joints[joint].name);
    }
  }
  return view;
}

/// Clusters of the project, and each single marker as one of its own.
std::vector<ClusterView> ClusterViews(const Project& project) {
  std::vector<ClusterView> views;
  std::set<int> in_cluster;
  for (const MarkerCluster& cluster : project.clusters) {
    ClusterView view{cluster.name, project.tree.links[cluster.link].name, {}};
    for (const int marker : cluster.markers) {
      view.markers.push_back(project.markers[marker].name);
      in_cluster.insert(marker);
    }
    views.push_back(std::move(view));
  }
  for (std::size_t m = 0; m < project.markers.size(); ++m) {
    if (in_cluster.contains(static_cast<int>(m))) continue;
    const Marker& marker = project.markers[m];
    views.push_back({marker.name, project.tree.links[marker.link].name, {marker.name}});
  }
  return views;
}

/// Where a mesh of a URDF is: beside it or, of `package://NAME/rest`, below the folder NAME that
/// the URDF is in.
fs::path MeshPath(const std::string& name, const fs::path& urdf) {
  const std::string scheme = "package://";
  if (!name.starts_with(scheme)) return urdf.parent_path() / name;
  const fs::path rest = name.substr(scheme.size());
  for (fs::path folder = fs::absolute(urdf).parent_path(); folder.has_relative_path();
       folder = folder.parent_path()) {
    if (folder.filename() == *rest.begin()) return folder.parent_path() / rest;
  }
  return {};
}

/// STL files that the URDF names and that are there, by the names that it has for them; up to some
/// megabytes, so that a report stays small.
std::map<std::string, std::string> FindMeshes(const std::string& urdf, const fs::path& file) {
  constexpr std::size_t kMostBytes = 2000000;
  const std::string before = "filename=\"";
  std::map<std::string, std::string> meshes;
  std::size_t bytes = 0;
  for (std::size_t at = urdf.find(before); at != std::string::npos;
       at = urdf.find(before, at + 1)) {
    const std::size_t begin = at + before.size();
    const std::string name = urdf.substr(begin, urdf.find('"', begin) - begin);
    const bool stl = name.ends_with(".stl") || name.ends_with(".STL");
    const fs::path mesh = stl && !meshes.contains(name) ? MeshPath(name, file) : fs::path();
    std::error_code error;
    if (mesh.empty() || !fs::is_regular_file(mesh, error)) continue;
    const std::size_t size = fs::file_size(mesh, error);
    if (error || bytes + size > kMostBytes) continue;
    bytes += size;
    meshes[name] = ReadFile(mesh);
  }
  return meshes;
}

RobotView ViewOf(const Project& project) {
  RobotView view{project.tree, ReadFile(project.urdf), {}, {}, {}, {}};
  view.meshes = FindMeshes(view.urdf, project.urdf);
  for (const Chain& chain : project.chains) view.chains.push_back(ViewOf(chain, project.tree));
  for (const CollisionSphere& sphere : project.motion.spheres) {
    view.spheres.push_back(
        {project.tree.links[sphere.link].name, sphere.p_link_centre, sphere.radius});
  }
  for (const ChainSetup& setup : project.motion.chains) {
    if (!setup.box) continue;
    view.workspaces.push_back(
        {setup.name, project.tree.links[0].name, setup.box->lower, setup.box->upper});
  }
  return view;
}

LabelledCalibration ReadCalibrationOf(const fs::path& given) {
  const bool folder = fs::is_directory(given);
  const fs::path file = folder ? given / "calibration.yaml" : given;
  LabelledCalibration calibration{given.lexically_normal().string(), ReadEstimate(file)};
  const fs::path covariance = file.parent_path() / "covariance.csv";
  if (fs::exists(covariance)) ReadCovariance(covariance, calibration.estimate);
  return calibration;
}

}  // namespace

const char* const kNoPage =
    "no report.html: this program was built without Node.js, so it lacks the page; install nodejs "
    "and npm, then configure and build again";

void SetCommandLine(int argc, char** argv) {
  CommandLine().assign(argv, argv + argc);
  if (argc > 0) CommandLine()[0] = "elastocal";
}

std::future<std::vector<InputRecord>> StartRecordingInputs(const Project& project,
                                                           const std::vector<fs::path>& inputs) {
  std::vector<fs::path> files = {project.file, project.urdf};
  for (const fs::path& input : inputs) {
    if (!IsRecordingFolder(input)) {
      files.push_back(input);
      continue;
    }
    files.push_back(input / "experiment.yaml");
    for (const TrialFiles& trial : ReadExperiment(input, project).trials) {
      files.insert(files.end(), {trial.markers, trial.joints});
    }
  }
  return std::async(std::launch::async, [files] { return RecordInputs(files); });
}

std::string RunsJson(const fs::path& folder, const std::string& command,
                     const CommonOptions& options, std::vector<InputRecord> inputs) {
  const fs::path file = folder / "runs.json";
  std::error_code error;
  const std::string before = fs::is_regular_file(file, error) ? ReadFile(file) : std::string();
  return UpdateRuns(before, {command, QuoteCommandLine(CommandLine()), ELASTOCAL_VERSION,
                             options.seed, std::move(inputs)});
}

std::string RobotDataJson(const Project& project) { return MakeRobotDataJson(ViewOf(project)); }

std::string CalibrationDataJson(const Session& session, const CalibrationRun& run) {
  const HeldOut* held_out = run.held_out ? &*run.held_out : nullptr;
  const CalibrationView view{
      .robot = ViewOf(session.project),
      .clusters = ClusterViews(session.project),
      .recording = session.recording,
      .comparison = run.comparison,
      .validation = session.validation,
      .held_out = held_out,
      .trials = run.trials,
      .error_table = held_out != nullptr ? MakeErrorTableJson(held_out->table).dump() : ""};
  return MakeReportDataJson(view);
}

std::string MakeFolderPage(const fs::path& folder, const std::vector<std::string>& earlier) {
  if (!fs::is_directory(folder)) {
    throw InputError(folder.string() + ": is no folder; expected one that calibrate -o wrote to");
  }
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file()) names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  ReportSources sources{folder.lexically_normal().string(), ELASTOCAL_VERSION, {}, {}};
  for (const std::string& name : ReportFiles(names)) {
    sources.files[name] = ReadFile(folder / name);
  }
  if (sources.files.empty()) {
    throw InputError(folder.string() +
                     ": nothing to report in this folder; expected summary.json of calibrate -o, "
                     "or what design or plan write");
  }
  for (const std::string& calibration : earlier) {
    sources.calibrations.push_back(ReadCalibrationOf(calibration));
  }
  if (fs::exists(folder / "calibration.yaml")) {
    sources.calibrations.push_back(ReadCalibrationOf(folder));
  }
  return MakePage(PageTemplate(), MakeReportJson(sources));
}

void WritePlanningReport(const fs::path& output, const std::string& command,
                         const CommonOptions& options, const Project& project,
                         const std::vector<fs::path>& inputs) {
  const fs::path folder = output.has_parent_path() ? output.parent_path() : fs::path(".");
  std::vector<fs::path> files = {project.file, project.urdf};
  files.insert(files.end(), inputs.begin(), inputs.end());
  WriteFiles({{folder / "runs.json", RunsJson(folder, command, options, RecordInputs(files))},
              {folder / "robot_data.json", RobotDataJson(project)}});
  WriteFolderReport(folder, options.Silent());
}

void WriteFolderReport(const fs::path& folder, bool quiet) {
  if (PageTemplate().empty()) {
    Print(quiet, std::string(kNoPage) + "\n");
    return;
  }
  const fs::path file = folder / "report.html";
  try {
    WriteFile(file, MakeFolderPage(folder));
  } catch (const InputError& error) {
    // The results themselves are written: something else in the folder cannot be shown.
    spdlog::warn("no report: {}", error.what());
    return;
  }
  Print(quiet, fmt::format("Report: {}\n", file.string()));
}

}  // namespace elastocal::cli
