// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/correction_limits.hpp"

#include <cmath>

#include <CLI/CLI.hpp>

#include "elastocal/cli/option_checks.hpp"

namespace elastocal::cli {
namespace {

constexpr double kDegreesOfLimit = 180.0 / M_PI;

}  // namespace

CorrectionLimits::CorrectionLimits() {
  const CompensatorOptions own;
  most_bend_deg = own.largest_turn_rad * kDegreesOfLimit;
  most_bend_mm = 1e3 * own.largest_shift_m;
  most_change_deg = own.largest_correction_rad * kDegreesOfLimit;
}

CompensatorOptions CorrectionLimits::Of() const {
  const CorrectionLimits own;  // what was not given keeps its bits
  CompensatorOptions options;
  if (most_bend_deg != own.most_bend_deg)
    options.largest_turn_rad = most_bend_deg / kDegreesOfLimit;
  if (most_bend_mm != own.most_bend_mm) options.largest_shift_m = 1e-3 * most_bend_mm;
  if (most_change_deg != own.most_change_deg) {
    options.largest_correction_rad = most_change_deg / kDegreesOfLimit;
  }
  return options;
}

void AddCorrectionLimits(CLI::App& command, CorrectionLimits& limits) {
  command
      .add_option("--most-bend-deg", limits.most_bend_deg,
                  "Limit of the rotation of a spring, so that no wrong load gives a dangerous "
                  "command: what is beyond it is not corrected")
      ->check(InBounds("compensate --most-bend-deg"))
      ->capture_default_str();
  command
      .add_option("--most-bend-mm", limits.most_bend_mm,
                  "Likewise of the translation of a spring (sliding joints, legs)")
      ->check(InBounds("compensate --most-bend-mm"))
      ->capture_default_str();
  command
      .add_option("--most-change-deg", limits.most_change_deg,
                  "Limit of the change of a joint's command from the nominal one; of a sliding "
                  "joint, one degree stands for 17.5 mm")
      ->check(InBounds("compensate --most-change-deg"))
      ->capture_default_str();
}

}  // namespace elastocal::cli
