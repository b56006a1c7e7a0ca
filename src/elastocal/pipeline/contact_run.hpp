#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/contact/standing_robot.hpp"
#include "elastocal/contact/touch_figures.hpp"
#include "elastocal/io/calibrated_urdf.hpp"
#include "elastocal/io/project.hpp"
#include "elastocal/math/progress.hpp"
#include "elastocal/validation/verdict.hpp"

namespace elastocal {

struct ContactRunOptions {
  /// Folds of the cross-validation, 2 to the number of touches; 0: none. By default one a touch, up
  /// to ten.
  std::optional<int> folds = {};
  int threads = 1;
  ZeroOffsets zero_offsets = ZeroOffsets::kOrigin;
  Progress progress = {};
};

/// An estimate with its errors in and out of sample.
struct ContactOutcome {
  ContactEstimate estimate;
  TouchFigures in_sample;
  TouchCrossValidation held_out;  ///< folds 0: none
};

/// A calibration from touches.
struct ContactRun {
  std::string recording;  ///< the files, for people
  Touches touches;
  ContactModel model;
  ContactOutcome uncalibrated;  ///< plates, tables and sessions only
  ContactOutcome calibrated;
  /// Where joints are elastic: the robot without compliances. The URDF has its geometry, because a
  /// URDF has no springs.
  std::optional<ContactOutcome> geometric;
  ClosureEvidence closure;
  double gain_in_sds = 0.0;  ///< of calibrated on held-out (or the same) touches, see GainInSds
  CalibrationResult result;  ///< the parameters of the robot
  Verdict verdict;
  std::optional<CalibratedUrdf> urdf;  ///< nothing where the verdict has objections
  ZeroOffsets zero_offsets = ZeroOffsets::kOrigin;
  std::vector<std::string> warnings;

  /// On touches that were left out, where there are folds, else on those of the fit.
  static const TouchFigures& Judged(const ContactOutcome& outcome) {
    return outcome.held_out.folds > 0 ? outcome.held_out.figures : outcome.in_sample;
  }
  bool deployable() const { return verdict.objections.empty(); }
};

/// Calibrates a robot that touches tables while it stands on its feet, without a tracker: see
/// EstimateContacts. `recordings`: tables of touches. The same input gives the same bits. Throws
/// InputError for tables that cannot be read (ReadTouchTables) and folds that they do not allow.
ContactRun CalibrateContacts(const Project& project,
                             const std::vector<std::filesystem::path>& recordings,
                             const ContactRunOptions& options);

/// What the touches that are left out, and how far they are off, are called: "left.csv:7: ...", one
/// sentence each.
std::vector<std::string> DescribeOutliers(const ContactRun& run);

/// summary.json (docs/formats.md).
std::string MakeContactSummary(const ContactRun& run);

/// The files of a calibration by name, as MakeCalibrationFiles has them.
std::map<std::string, std::string> MakeContactFiles(const Project& project, ContactRun& run);

}  // namespace elastocal
