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
  /// Of a design from nothing, which has curves as well.
  std::optional<PostureDesign> whole = {};
  PostureDesignOptions options = {};

  /// The posture file.
  std::string text() const { return FormatPostureFile(project.tree, postures); }
};

/// Postures that a user gives: a Design, a posture file, or a dict of chains with arrays
/// (postures, joints) or lists of dicts of joints. They are read as from a file, so that they have
/// its bits. A chain of a dict stands on the feet that the project gives it.
std::vector<ChainPostures> PosturesOf(const py::object& given, const Project& project);

}  // namespace elastocal::python
