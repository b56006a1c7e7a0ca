// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <Eigen/Core>

#include "elastocal/io/posture_table.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"

namespace elastocal {

/// Writes a table of eight postures on another day, on which one parameter has changed.
inline std::string AnotherDay(const std::filesystem::path& table, const std::string& project_file,
                              Eigen::VectorXd truth, const std::string& parameter, double change) {
  const Project project = ReadProject(project_file);
  const ErrorModel model = MakeErrorModel(project.tree, project.markers, project.placement);
  truth[FindParameter(model.parameters, parameter)] += change;
  WritePostureTable(table, MakeSyntheticRecording(model, truth, {.postures = 8, .seed = 5}),
                    project.tree);
  return table.string();
}

}  // namespace elastocal
