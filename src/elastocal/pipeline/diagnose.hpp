// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/pipeline/choose_causes.hpp"

namespace elastocal {

/// The causes of the errors that a calibration leaves.
struct Diagnosis {
  CauseReport report;
  std::string calibration_fingerprint;
  std::string recording;
  std::vector<std::filesystem::path> inputs;
  std::vector<std::string> warnings;  ///< sentences
  double seconds = 0.0;
};

/// Studies the recording from which the calibration in a folder was made (runs.json beside it),
/// with the mistakes corrected that calibrate was told to correct. For tables of observations the
/// study is beside the earlier calibration that was the prior. Throws InputError where the record,
/// the project or the recording is missing or has changed.
Diagnosis Diagnose(const std::filesystem::path& folder, const std::filesystem::path& project,
                   std::optional<std::uint64_t> seed);

/// A cause as text: "arm_6_joint: hysteresis of 7.6 +- 0.8 mrad, by the direction of its last
/// motion; alone it takes the held-out error from 2.66 to 2.30 mm".
std::string DescribeCause(const CauseReport& report, const CauseFinding& finding);

/// The diagnosis as text, a sentence each.
std::vector<std::string> DescribeDiagnosis(const CauseReport& report);

/// candidates[], chosen[] and the held-out errors, as JSON (docs/formats.md).
std::string MakeDiagnosisJson(const Diagnosis& diagnosis);

}  // namespace elastocal
