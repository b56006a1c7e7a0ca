// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "elastocal/posture/chain_problem.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// A chain for which postures are sought, with its error model (for the markers that are seen) and
/// identifiable parameters. Problems keep references to the model, which therefore has a fixed
/// address.
struct DesignedChain {
  ChainSetup setup;
  std::unique_ptr<ErrorModel> model;
  BaseParameters base;
};

/// Prepares a chain. With `elastic`, the joints' compliances (torsion and bending) are parameters,
/// too. With `towards_root`, the markers on all bodies that carry the chain are also seen. Throws
/// InputError where the chain carries no markers.
DesignedChain PrepareChain(const Project& project, const ChainSetup& setup, bool elastic,
                           bool towards_root = false);

/// The chain set-ups of the project's section `design` with these names, or all of them. Throws
/// InputError for an unknown name, and where the project has no section `design`.
std::vector<ChainSetup> ChosenSetups(const Project& project, const std::vector<std::string>& names);

/// Set-up of the mirror image of a chain. Throws InputError where it has none.
ChainSetup OtherSide(const Project& project, const ChainSetup& setup);

/// The project's chain set-ups, each followed by its mirror image if it has one.
std::vector<ChainSetup> SetupsOfBothSides(const Project& project);

}  // namespace elastocal
