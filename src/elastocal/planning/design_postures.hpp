// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/files/output_set.hpp"
#include "elastocal/io/posture_file.hpp"
#include "elastocal/math/progress.hpp"
#include "elastocal/posture/design.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// Settings of DesignPostures.
struct PostureDesignOptions {
  /// Chains of the project's section `design`; empty: all. A chain's mirror image is always
  /// included.
  std::vector<std::string> chains = {};
  /// Also determine the compliances of the joints (eq. 5), and of the leg if a single one stands
  /// (eq. 6).
  bool elastic = false;
  /// Also finds the indices that the other algorithms reach with as many postures; takes several
  /// times as long.
  bool compare_algorithms = false;
  DesignOptions design = {};  ///< settings for each chain
};

/// The postures of one chain, and the time to find them.
struct DesignedPostures {
  ChainDesign design;
  double seconds = 0.0;
};

/// Calibration postures of a robot.
struct PostureDesign {
  std::vector<DesignedPostures> chains;  ///< each followed by its mirror image, if it has one
  std::vector<CurvePoint> curves;        ///< index against number of postures
  /// Why there are no postures that determine the parameters of the last chain; empty where there
  /// are for all. Then the design has ended early and is of no use.
  std::string infeasible;

  std::vector<ChainPostures> postures() const;
  int posture_count() const;
  std::vector<std::string> warnings() const;  ///< notes on the chains, each with the chain's name
};

/// Finds, chain by chain, the smallest set of feasible postures that tells most of the identifiable
/// parameters (paper, section 3). The chain on the other side of the robot gets the mirrored
/// postures. The same seed gives the same postures. Progress counts chains.
///
/// Throws InputError for a chain that the section `design` does not have or that carries no
/// markers, where there is no such section, and for an exchange design by another criterion than
/// O1.
PostureDesign DesignPostures(const Project& project, const PostureDesignOptions& options,
                             const Progress& progress = {});

/// Files written by `design`: the posture file and, for `postures.yaml`, postures_summary.json,
/// postures_curves.csv and postures_curves.svg beside it (docs/formats.md, Postures).
struct DesignFiles {
  explicit DesignFiles(const std::filesystem::path& output);

  std::filesystem::path postures, summary, curves, picture;

  /// Declares the files in the set, with the beginnings by which such files are recognised.
  void Declare(OutputSet& outputs) const;
};

/// Sets the contents of these files, which must be declared.
void SetDesignFiles(const DesignFiles& files, const Project& project, const PostureDesign& design,
                    const PostureDesignOptions& options, OutputSet& outputs);

/// Contents of postures_summary.json.
std::string FormatDesignSummary(const Project& project, const PostureDesign& design,
                                const PostureDesignOptions& options);

/// Result of the search for a chain's postures, in a word or two.
const char* StatusText(DesignResult::Status status);

}  // namespace elastocal
