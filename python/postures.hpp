// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bindings.hpp"
#include "elastocal/planning/design_postures.hpp"

namespace elastocal::python {

/// Postures that were designed in this process.
struct PyDesign {
  Project project;
  std::vector<ChainPostures> postures;
  std::string summary;  ///< JSON
  Names warnings = {};
  /// The whole design, with its curves, if it did not start from a calibration.
  std::optional<PostureDesign> whole = {};
  PostureDesignOptions options = {};

  /// The posture file.
  std::string text() const { return FormatPostureFile(project.tree, postures); }
};

/// Postures from a user: a Design, a posture file, or a dict of chains with arrays (postures,
/// joints) or lists of dicts of joints. They are converted through the text of a file, so that they
/// have the same bits. A chain of a dict stands on the feet that the project states for it.
std::vector<ChainPostures> PosturesOf(const py::object& given, const Project& project);

}  // namespace elastocal::python
