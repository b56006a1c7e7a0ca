// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "elastocal/posture/chain_problem.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// A chain for which postures are sought, with its error model (of the markers that are seen) and
/// the parameters of it that can be identified. Problems refer to the model, so the model has an
/// address that stays.
struct DesignedChain {
  ChainSetup setup;
  std::unique_ptr<ErrorModel> model;
  BaseParameters base;
};

/// `elastic`: the joints' compliances (torsion and bending) are to be identified as well.
/// `towards_root`: the markers on all bodies that carry the chain are seen besides.
/// Throws InputError where the chain carries no markers.
DesignedChain PrepareChain(const Project& project, const ChainSetup& setup, bool elastic,
                           bool towards_root = false);

/// The chain set-ups of the project's section `design` with these names, or all of them. Throws
/// InputError for an unknown name, and where the project has no section `design`.
std::vector<ChainSetup> ChosenSetups(const Project& project, const std::vector<std::string>& names);

/// Set-up of the chain on the other side. Throws InputError where there is no mirror image.
ChainSetup OtherSide(const Project& project, const ChainSetup& setup);

/// The project's chain set-ups, each followed by that of the other side where it has one.
std::vector<ChainSetup> SetupsOfBothSides(const Project& project);

}  // namespace elastocal
