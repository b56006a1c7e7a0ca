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

inline constexpr int kNextPostures = 5;  ///< that are usually proposed

/// Postures to be recorded after a check that could not name the joint that has changed.
struct NextPostures {
  std::vector<ChainPostures> postures;  ///< by chain that moves a suspect; empty where none is open
  std::string
      why_none;  ///< why there are none although the check leaves something open, else empty
};

/// Chooses `count` postures of each chain that moves one of the suspects of a check, which tell
/// best which of them has changed (DesignFollowUp). The seed is that of the check, or 1. Throws
/// what DesignFollowUp throws.
NextPostures DesignNextPostures(const Project& project, const std::filesystem::path& calibration,
                                const CheckRun& run, const CheckOptions& options,
                                int count = kNextPostures, const Progress& progress = {});

/// The same after a check by tables of observations: `count` postures in all, touches and looks
/// (DesignObservations). Throws what DesignObservations throws.
NextPostures DesignNextPostures(const Project& project, const std::filesystem::path& calibration,
                                const ContactCheck& run, const CheckOptions& options,
                                int count = kNextPostures, const Progress& progress = {});

/// MakeCheckJson with these postures (docs/formats.md).
std::string MakeCheckJson(const Project& project, const CheckRun& run, const NextPostures& next);
std::string MakeCheckJson(const Project& project, const ContactCheck& run,
                          const NextPostures& next);

}  // namespace elastocal
