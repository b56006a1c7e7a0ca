// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/readers/recording_file.hpp"

namespace elastocal {

/// As experiment.yaml has it: "calibration", "sine", "random", "repeatability".
std::string TrialKindName(TrialKind kind);
/// The kind with this name; nothing for an unknown name.
std::optional<TrialKind> TrialKindNamed(const std::string& name);

/// One motion as it was recorded, by cameras and robot.
struct TrialFiles {
  std::string name;
  TrialKind kind = TrialKind::kCalibration;
  std::vector<int> chains;  ///< chains that it exercises, indices into Project::chains; one or more
  std::vector<int>
      support;  ///< links of the tree that stand on the floor; empty: the root is held or free
  bool free_root = false;  ///< whether the root is free (`support` is then empty)
  bool moments = false;    ///< samples are moments of the motion (of a sine they always are)
  /// Files of cameras and robot, in any format that is read; the same file if a bag has both.
  std::filesystem::path markers, joints;
  ReaderOptions reading = {};  ///< what these files do not say by themselves
  /// Camera time less robot time at the beginning, s, if it is known.
  std::optional<double> expected_lag_s = {};
  std::filesystem::path truth = {};  ///< of a simulated trial, see ReadWaistTruth; empty: unknown
  int session = 0;                   ///< number of the folder that it is from
};

/// The contents of a recording folder.
struct Experiment {
  std::vector<TrialFiles> trials;            ///< one or more, names and files all different
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};  ///< in the cameras' frame, m/s^2
  bool up_given = false;  ///< whether the user says which axis points up; if not, files may
};

/// Reads `folder`/experiment.yaml (docs/formats.md). Files in it are seen from the folder and must
/// be there; they are not opened. Throws InputError naming file, line and key: what ReadProject
/// refuses in values, chains that the project does not have, supports that are not the tip of a
/// chain, files that are absent or used twice, no trial.
Experiment ReadExperiment(const std::filesystem::path& folder, const Project& project);

/// The same from the text of the file.
Experiment ParseExperiment(const std::string& text, const std::filesystem::path& folder,
                           const Project& project);

/// The text of `folder`/experiment.yaml for such trials, with files as seen from the folder.
std::string FormatExperiment(const std::filesystem::path& folder, const Experiment& experiment,
                             const Project& project);

/// Writes it.
void WriteExperiment(const std::filesystem::path& folder, const Experiment& experiment,
                     const Project& project);

}  // namespace elastocal
