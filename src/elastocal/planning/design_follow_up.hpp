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

/// Settings of DesignFollowUp.
struct FollowUpOptions {
  SequentialAim aim = SequentialAim::kParameters;
  int postures = 8;         ///< number of postures of each chain
  double days = 1.0;        ///< time since the calibration
  double marker_sd = 3e-4;  ///< noise of a marker coordinate, m
  /// Chains of the project's section `design` or their mirror images; empty: all, or those that
  /// move `joints`.
  std::vector<std::string> chains = {};
  /// Joints whose changes the postures must tell, for SequentialAim::kChanges; empty: all.
  std::vector<std::string> joints = {};
  std::uint64_t seed = 1;
};

/// How exactly postures tell a change of a joint's zero.
struct ZeroSensitivity {
  std::string joint;
  bool prismatic = false;
  double sd = 0.0;  ///< rad or m; infinite: a change of the expected size cannot be told
  /// Smallest change that check would find (SmallestChange), rad or m; infinite likewise.
  double smallest_seen = 0.0;
};

/// `zeros` of the JSON output (docs/formats.md).
nlohmann::ordered_json ZerosJson(const std::vector<ZeroSensitivity>& zeros);

/// Postures chosen for one chain.
struct FollowUpChain {
  ChainPostures postures;
  double information = 0.0;  ///< expected, nats: see ExpectedInformation
  std::vector<ZeroSensitivity> zeros;
};

/// Result of DesignFollowUp.
struct FollowUpDesign {
  std::vector<FollowUpChain> chains;
  std::string infeasible;  ///< reason why a chain has no posture; empty where all have

  std::vector<ChainPostures> postures() const;
};

/// Chooses postures for a calibrated robot: those that add most to what is known, or that tell
/// whether a joint has moved since (see SequentialDesign). Each chain is treated by itself, because
/// what is known differs between the two sides.
///
/// `calibration` is the folder that calibrate wrote to, or its calibration.yaml, with its
/// covariance. Throws InputError for files that cannot be read, for a calibration of another robot,
/// and for an unknown chain or joint.
FollowUpDesign DesignFollowUp(const Project& project, const std::filesystem::path& calibration,
                              const FollowUpOptions& options, const Progress& progress = {});

/// The figures for programs (docs/formats.md).
std::string MakeFollowUpJson(const FollowUpDesign& design, const FollowUpOptions& options);

}  // namespace elastocal
