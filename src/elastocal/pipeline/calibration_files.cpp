// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/calibration_files.hpp"

#include <cmath>

#include "elastocal/files/output_set.hpp"
#include "elastocal/io/calibration_file.hpp"
#include "elastocal/io/covariance_file.hpp"
#include "elastocal/io/linkage_file.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/checksums.hpp"
#include "elastocal/pipeline/robot_views.hpp"
#include "elastocal/pipeline/summary.hpp"
#include "elastocal/tables/read_file.hpp"

namespace elastocal {
namespace {

HeldOutErrors HeldOutErrorsOf(const CalibrationRun& run) {
  if (!run.held_out && run.cross_validation.folds == 0) return {};
  const Deployment& deployed = run.deployment;
  const double best = std::isfinite(deployed.compensated) ? deployed.compensated : deployed.urdf;
  return {.urdf = deployed.urdf, .compensated = best};
}

/// Data of the report for project and run; adds to the run's warnings.
std::string MakeReportData(const Project& project, CalibrationRun& run) {
  const CalibrationView view{.robot = MakeRobotView(project, run.warnings),
                             .clusters = MakeClusterViews(project),
                             .recording = run.recording,
                             .comparison = run.comparison,
                             .validation = run.validation,
                             .held_out = run.held_out ? &*run.held_out : nullptr,
                             .trials = run.trials};
  return MakeReportDataJson(view);
}

}  // namespace

std::string CalibratedUrdfName(const std::filesystem::path& urdf) {
  return urdf.stem().string() + "_calibrated.urdf";
}

std::vector<std::string> CalibrationFileNames(const Project& project) {
  std::vector<std::string> names = {CalibratedUrdfName(project.urdf),
                                    "calibration.yaml",
                                    "offsets.xacro",
                                    "covariance.csv",
                                    "summary.json",
                                    "report_data.json"};
  if (!project.tree.linkages.empty()) names.emplace_back("linkages.yaml");
  return names;
}

std::map<std::string, std::string> MakeCalibrationFiles(const Project& project,
                                                        CalibrationRun& run) {
  std::map<std::string, std::string> files;
  if (run.urdf) {
    const CalibrationResult& result = run.comparison.largest();
    const auto& results = run.comparison.results;
    const ModelKind in_urdf = run.deployment.urdf_kind;
    const bool same = in_urdf == result.kind || in_urdf == ModelKind::kRigid;
    files[CalibratedUrdfName(project.urdf)] = run.urdf->text;
    files["calibration.yaml"] = MakeCalibrationYaml(
        result, run.recording.source, run.zero_offsets,
        {.uncalibrated = &results[static_cast<int>(ModelKind::kUncalibrated)],
         .in_urdf = same ? nullptr : &results[static_cast<int>(in_urdf)],
         .gravity = run.recording.gravity,
         .rmse_3d = run.comparison.metrics_all[static_cast<int>(result.kind)].rmse_3d,
         .held_out = HeldOutErrorsOf(run),
         .soles = run.soles});
    files["offsets.xacro"] = MakeXacroOffsets(*run.urdf);
    files["covariance.csv"] = MakeCovarianceCsv(result);
    if (!project.tree.linkages.empty()) {
      // The rods belong to the URDF: springs carry a part of what rods of another fit explain.
      files["linkages.yaml"] = MakeLinkagesYaml(same ? result : results[static_cast<int>(in_urdf)]);
    }
  }
  files["report_data.json"] = MakeReportData(project, run);
  files["summary.json"] = MakeSummaryJson(run);
  return files;
}

CalibrationFiles FindCalibrationFiles(const std::filesystem::path& given) {
  const bool is_folder = FileTypeOf(given) == std::filesystem::file_type::directory;
  const std::filesystem::path folder = is_folder ? given : given.parent_path();
  RecoverOutputs(folder.empty() ? "." : folder);
  CheckChecksums(folder);
  const CalibrationFiles files{is_folder ? given / "calibration.yaml" : given,
                               folder / "covariance.csv"};
  if (is_folder && FileTypeOf(files.calibration) == std::filesystem::file_type::not_found) {
    throw InputError(given.string() + ": no calibration.yaml in this folder; expected the folder " +
                     "that calibrate wrote a result to that can be deployed");
  }
  return files;
}

CalibrationEstimate ReadCalibrationFiles(const CalibrationFiles& files) {
  CalibrationEstimate estimate = ReadEstimate(files.calibration);
  if (FileTypeOf(files.covariance) != std::filesystem::file_type::not_found) {
    ReadCovariance(files.covariance, estimate);
  }
  return estimate;
}

}  // namespace elastocal
