// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/io/posture_file.hpp"
#include "elastocal/math/progress.hpp"
#include "elastocal/pipeline/check_calibration.hpp"
#include "elastocal/pipeline/contact_check.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

inline constexpr int kNextPostures = 5;  ///< usual number of proposed postures

/// Postures to be recorded after a check that could not name the joint that has moved.
struct NextPostures {
  /// By chain that moves a suspect; empty where nothing is open.
  std::vector<ChainPostures> postures;
  std::string
      why_none;  ///< reason why there are none although the check leaves something open, else empty
};

/// Chooses `count` postures of each chain that moves a suspect of a check, such that they tell best
/// which suspect has moved (DesignFollowUp). The seed is that of the check, or 1. Throws as
/// DesignFollowUp.
NextPostures DesignNextPostures(const Project& project, const std::filesystem::path& calibration,
                                const CheckRun& run, const CheckOptions& options,
                                int count = kNextPostures, const Progress& progress = {});

/// As above, after a check by tables of observations: `count` postures altogether, touches and
/// looks (DesignObservations). Throws as DesignObservations.
NextPostures DesignNextPostures(const Project& project, const std::filesystem::path& calibration,
                                const ContactCheck& run, const CheckOptions& options,
                                int count = kNextPostures, const Progress& progress = {});

/// MakeCheckJson with these postures (docs/formats.md).
std::string MakeCheckJson(const Project& project, const CheckRun& run, const NextPostures& next);
std::string MakeCheckJson(const Project& project, const ContactCheck& run,
                          const NextPostures& next);

}  // namespace elastocal
