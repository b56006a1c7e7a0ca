// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "elastocal/io/posture_file.hpp"
#include "elastocal/math/progress.hpp"
#include "elastocal/posture/sequential.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

struct FollowUpOptions {
  SequentialAim aim = SequentialAim::kParameters;
  int postures = 8;         ///< of each chain
  double days = 1.0;        ///< since the calibration
  double marker_sd = 3e-4;  ///< of a coordinate, m
  /// Of the project's section `design`, mirror images included; empty: all, or those that move
  /// `joints`.
  std::vector<std::string> chains = {};
  /// Whose changes shall be told, with SequentialAim::kChanges; empty: all.
  std::vector<std::string> joints = {};
  std::uint64_t seed = 1;
};

/// How well the postures tell a change of a joint's zero.
struct ZeroSensitivity {
  std::string joint;
  bool prismatic = false;
  double sd = 0.0;  ///< rad or m; infinite: they cannot tell one of the size that is expected
  double smallest_seen = 0.0;  ///< by check (SmallestChange), rad or m; infinite likewise
};

/// `zeros` of the figures for programs (docs/formats.md).
nlohmann::ordered_json ZerosJson(const std::vector<ZeroSensitivity>& zeros);

struct FollowUpChain {
  ChainPostures postures;
  double information = 0.0;  ///< expected, nats: see ExpectedInformation
  std::vector<ZeroSensitivity> zeros;
};

struct FollowUpDesign {
  std::vector<FollowUpChain> chains;
  std::string infeasible;  ///< why a chain has no posture; empty where all have

  std::vector<ChainPostures> postures() const;
};

/// Chooses postures for a robot that has been calibrated: those that add most to what is known, or
/// that tell whether a joint has moved since (see SequentialDesign). Each chain by itself: what is
/// known of the two sides differs.
///
/// `calibration`: the folder that calibrate wrote to, or its calibration.yaml, with its covariance.
/// Throws InputError: files that cannot be read; a calibration of another robot; an unknown chain
/// or joint.
FollowUpDesign DesignFollowUp(const Project& project, const std::filesystem::path& calibration,
                              const FollowUpOptions& options, const Progress& progress = {});

/// The figures for programs (docs/formats.md).
std::string MakeFollowUpJson(const FollowUpDesign& design, const FollowUpOptions& options);

}  // namespace elastocal
