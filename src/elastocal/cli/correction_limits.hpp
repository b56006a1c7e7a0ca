// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/App.hpp>

#include "elastocal/runtime/compensator.hpp"

namespace elastocal::cli {

/// Limits on corrections as options of a command, in the units of users.
struct CorrectionLimits {
  double most_bend_deg, most_bend_mm, most_change_deg;

  CorrectionLimits();  ///< those of CompensatorOptions
  CompensatorOptions Of() const;
};

void AddCorrectionLimits(CLI::App& command, CorrectionLimits& limits);

}  // namespace elastocal::cli
