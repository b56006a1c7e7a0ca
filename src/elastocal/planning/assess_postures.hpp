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

struct PostureAssessmentOptions {
  std::vector<std::string> chains = {};  ///< only these; empty: all that the postures are of
  /// The compliances of the joints (eq. 5), and of the one leg that stands (eq. 6), shall be
  /// determined as well.
  bool elastic = false;
  AssessOptions assess = {};  ///< of each chain
};

/// What the postures of one chain are worth.
struct ChainAssessment {
  ChainSetup setup;
  std::vector<Parameter> parameters;  ///< identifiable, one an entry of assessment.parameter_sd
  int posture_count = 0;
  Assessment assessment;

  /// Entries of `parameters` with the largest standard deviations, the largest first; at most
  /// `count`, and none of the waist's and the markers' parameters.
  std::vector<int> WeakestParameters(int count) const;
};

/// Assesses sets of postures, whoever chose them (paper, section 7): how much they tell, how far
/// that is from the most that is possible, which posture adds least and which one would add most.
/// Progress counts chains.
///
/// Throws InputError for a chain that the project's section `design` does not have, where there is
/// no such section, and where no set is of one of the chains asked for.
std::vector<ChainAssessment> AssessPostures(const Project& project,
                                            const std::vector<ChainPostures>& sets,
                                            const PostureAssessmentOptions& options,
                                            const Progress& progress = {});

/// The postures of a recording as sets: for each chain of the project's section `design` and its
/// mirror image, those of the trials that exercise it; of a posture table all.
std::vector<ChainPostures> RecordedPostures(const Project& project, const Recording& recording);

/// The assessments for programs (JSON), with the `weakest` weakest parameters of each.
std::string FormatAssessment(const std::vector<ChainAssessment>& chains, int weakest);

}  // namespace elastocal
