// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/io/posture_file.hpp"
#include "elastocal/math/progress.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/posture/assess.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// Settings of AssessPostures.
struct PostureAssessmentOptions {
  /// Names of the chains to assess; empty: all for which there are postures.
  std::vector<std::string> chains = {};
  /// Also assess the compliances of the joints (eq. 5), and of the leg if a single one stands (eq.
  /// 6).
  bool elastic = false;
  AssessOptions assess = {};  ///< settings for each chain
};

/// Assessment of the postures of one chain.
struct ChainAssessment {
  ChainSetup setup;
  /// Identifiable parameters, in the order of assessment.parameter_sd.
  std::vector<Parameter> parameters;
  int posture_count = 0;
  Assessment assessment;

  /// Entries of `parameters` with the largest standard deviations, the largest first; at most
  /// `count`, without those of waist and markers.
  std::vector<int> WeakestParameters(int count) const;
};

/// Assesses given sets of postures (paper, section 7): their information, its ratio to the largest
/// possible one, the posture that adds least, and the one that would add most. Progress counts
/// chains.
///
/// Throws InputError for a chain that the project's section `design` does not have, for a project
/// without that section, and where none of the requested chains has a set.
std::vector<ChainAssessment> AssessPostures(const Project& project,
                                            const std::vector<ChainPostures>& sets,
                                            const PostureAssessmentOptions& options,
                                            const Progress& progress = {});

/// The postures of a recording as sets. For each chain of the project's section `design` and its
/// mirror image these are the postures of the trials that exercise it; in a posture table all
/// postures.
std::vector<ChainPostures> RecordedPostures(const Project& project, const Recording& recording);

/// The assessments as JSON, with the `weakest` weakest parameters of each.
std::string FormatAssessment(const std::vector<ChainAssessment>& chains, int weakest);

}  // namespace elastocal
