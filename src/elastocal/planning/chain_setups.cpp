// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/chain_setups.hpp"

#include <algorithm>

#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

/// Elasticity that shows while the chain moves: that of its joints and of the leg on which the
/// robot stands, if it is one. (Statics does not tell how two legs share the load; a free root does
/// not show its own deflection.)
Elasticity ChainElasticity(const Project& project, const ChainSetup& setup) {
  const RobotTree& tree = project.tree;
  Elasticity elasticity;
  if (setup.support.size() == 1 && !project.motion.free_root) {
    for (const Chain& chain : project.chains) {
      if (chain.tip_link == setup.support[0]) elasticity.legs = {{chain.name, chain.tip_link}};
    }
  }
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    if (!IsMovedBy(tree.joints[k], setup.coordinates)) continue;
    elasticity.torsion.push_back(static_cast<int>(k));
    if (tree.joints[k].type == JointType::kRevolute) {
      elasticity.bending.push_back(static_cast<int>(k));
    }
  }
  return elasticity;
}

/// The markers of a chain. `towards_root`: also those on all bodies that carry it. With a free root
/// otherwise also the reference markers: those on the body at which the chain begins or, if it has
/// none, on the nearest body towards the root.
std::vector<std::string> SeenMarkers(const Project& project, const Chain& chain,
                                     bool towards_root) {
  std::vector<std::string> names = ChainMarkers(project, chain);
  if (names.empty() || !(project.motion.free_root || towards_root)) return names;
  const RobotTree& tree = project.tree;
  std::vector<int> bodies = {0};  // from the root outwards
  for (int joint : JointsToBody(tree, tree.links[chain.from_link].body)) {
    bodies.push_back(joint + 1);
  }
  std::reverse(bodies.begin(), bodies.end());
  for (const int body : bodies) {
    bool found = false;
    for (const Marker& marker : project.markers) {
      if (tree.links[marker.link].body != body) continue;
      if (std::ranges::count(names, marker.name) == 0) names.push_back(marker.name);
      found = true;
    }
    if (found && !towards_root) break;
  }
  return names;
}

}  // namespace

DesignedChain PrepareChain(const Project& project, const ChainSetup& setup, bool elastic,
                           bool towards_root) {
  const std::vector<std::string> markers =
      SeenMarkers(project, project.chains[FindChain(project, setup.name)], towards_root);
  if (markers.empty()) {
    throw InputError(project.file.string() + ": chain '" + setup.name + "' carries no markers");
  }
  const ErrorModel all = MakeErrorModel(project.tree, project.markers, project.placement,
                                        elastic ? ChainElasticity(project, setup) : Elasticity());
  DesignedChain chain;
  chain.setup = setup;
  chain.model = std::make_unique<ErrorModel>(SelectMarkers(all, markers));
  chain.base = FindChainParameters(*chain.model, project.motion, setup, project.identifiability);
  return chain;
}

std::vector<ChainSetup> ChosenSetups(const Project& project,
                                     const std::vector<std::string>& names) {
  if (project.motion.chains.empty()) {
    throw InputError(project.file.string() +
                     ": there is no section 'design' with 'chains', which say what the calibration "
                     "postures keep to");
  }
  if (names.empty()) return project.motion.chains;
  std::vector<ChainSetup> chosen;
  std::vector<std::string> known;
  for (const ChainSetup& setup : project.motion.chains) known.push_back(setup.name);
  for (const std::string& name : names) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) {
      throw InputError(project.file.string() + ": the section 'design' has no chain '" + name +
                       "'" + DidYouMean(name, known));
    }
    chosen.push_back(project.motion.chains[found - known.begin()]);
  }
  return chosen;
}

ChainSetup OtherSide(const Project& project, const ChainSetup& setup) {
  const Chain& other = project.chains[FindChain(project, setup.mirror)];
  std::string reason;
  const auto mirrored = MirrorSetup(project.tree, project.motion, setup, other.name,
                                    other.from_link, other.tip_link, &reason);
  if (!mirrored) {
    throw InputError(project.file.string() + ": chain '" + setup.name + "' has no mirror image '" +
                     setup.mirror + "': " + reason);
  }
  return *mirrored;
}

std::vector<ChainSetup> SetupsOfBothSides(const Project& project) {
  std::vector<ChainSetup> setups;
  for (const ChainSetup& setup : project.motion.chains) {
    setups.push_back(setup);
    if (!setup.mirror.empty()) setups.push_back(OtherSide(project, setup));
  }
  return setups;
}

}  // namespace elastocal
