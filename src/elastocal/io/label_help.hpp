// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/trial_summary.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// Texts separated by commas: the first of them, and how many more there are.
std::string FirstOf(const std::vector<std::string>& texts);

/// What the marker file of a trial has instead of its markers, with what was expected and the label
/// nearest to it, as the end of a sentence. Empty where it has a marker of the trial, or no other
/// label.
std::string DescribeLabels(const TrialSummary& summary, const Project& project);

}  // namespace elastocal
