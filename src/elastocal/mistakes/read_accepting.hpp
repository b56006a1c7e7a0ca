// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/project/project.hpp"
#include "elastocal/recorded/measurements.hpp"

namespace elastocal {

/// Measurements in which mistakes were corrected on request.
struct AcceptedMeasurements {
  Measurements measured;
  std::vector<std::string> undone;  ///< descriptions of the corrections (AcceptMistakes)
};

/// Reads recordings (ReadMeasurements) and corrects the accepted mistakes (AcceptMistakes). They
/// are known while clocks are told, because a reversed sign spoils the alignment: this sets
/// `accepted` of the project's measurements. Throws InputError as these two.
AcceptedMeasurements ReadAccepting(Project& project,
                                   const std::vector<std::filesystem::path>& recordings,
                                   const std::vector<std::string>& accepted,
                                   ReadFor purpose = ReadFor::kCalibration);

}  // namespace elastocal
