// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/inspect_robot.hpp"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "elastocal/pipeline/project_warnings.hpp"
#include "elastocal/robot/parameter_names.hpp"
#include "elastocal/robot/special_geometry.hpp"
#include "elastocal/robot/statics.hpp"
#include "elastocal/robot/subtree.hpp"
#include "elastocal/tables/json_text.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNearlyOne = 5e-3;  // m: distance between parallel axes

ChainInspection InspectChain(const std::string& name, const RobotTree& tree,
                             const std::vector<Marker>& markers, const Project& project,
                             const IdentifiabilityOptions& options) {
  ChainInspection chain{name, 0, MakeErrorModel(tree, markers, project.placement), {}, {}};
  chain.joints = static_cast<int>(chain.model.active_joints.size());
  chain.base = FindBaseParameters(chain.model, options);
  if (chain.base.geometric_count < chain.base.theoretical_count && options.hold.empty()) {
    chain.lost = LostBySpecialMarkers(chain.model, options);
  }
  return chain;
}

std::vector<Marker> MarkersOf(const Project& project, const Chain& chain) {
  std::vector<Marker> markers;
  for (const std::string& name : ChainMarkers(project, chain)) {
    for (const Marker& marker : project.markers) {
      if (marker.name == name) markers.push_back(marker);
    }
  }
  return markers;
}

/// Adds the markers on the body at which the chain begins. With a free root, they are the reference
/// for the others.
void AddMarkersOf(const Project& project, int body, std::vector<Marker>& markers) {
  for (const Marker& marker : project.markers) {
    if (project.tree.links[marker.link].body == body) markers.push_back(marker);
  }
}

Json PlacementsJson(const RobotTree& tree, const std::vector<JointPlacement>& placements) {
  Json json = Json::array();
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    const JointPlacement& p = placements[k];
    json.push_back({{"joint", tree.joints[k].name},
                    {"general", p.general},
                    {"parallel", p.parallel},
                    {"gamma", p.gamma},
                    {"b", p.b},
                    {"beta", p.beta},
                    {"alpha", p.alpha},
                    {"d", p.d},
                    {"theta", p.theta},
                    {"r", p.r}});
  }
  return json;
}

Json ChainJson(const ChainInspection& chain) {
  const auto names = [&](const std::vector<int>& which) {
    Json list = Json::array();
    for (int i : which) list.push_back(chain.model.parameters[i].name);
    return list;
  };
  Json regrouping = Json::object();
  for (std::size_t d = 0; d < chain.base.dropped.size(); ++d) {
    Json into = Json::object();
    for (const Share& share : RegroupedInto(chain.base, static_cast<int>(d))) {
      into[chain.model.parameters[share.parameter].name] = share.coefficient;
    }
    regrouping[chain.model.parameters[chain.base.dropped[d]].name] = into;
  }
  return {{"chain", chain.name},
          {"joints", chain.joints},
          {"markers", chain.model.marker_count()},
          {"parameters", chain.model.parameter_count()},
          {"identifiable", chain.base.geometric_count},
          {"identifiable_theory", chain.base.theoretical_count},
          {"smallest_kept", chain.base.smallest_kept},
          {"largest_dropped", chain.base.largest_dropped},
          {"held", names(chain.base.held)},
          {"kept", names(chain.base.kept)},
          {"dropped_regrouped_into", regrouping},
          {"lost_by_special_markers", names(chain.lost)}};
}

Json LinkagesJson(const RobotTree& tree) {
  Json linkages = Json::array();
  for (const Linkage& linkage : tree.linkages) {
    Json joints = Json::array();
    for (int k : linkage.joints) joints.push_back(tree.joints[k].name);
    Json rods = Json::array();
    for (const Rod& rod : linkage.rods) {
      Json errors = Json::array();
      for (const auto& [quantity, sd] : rod.uncertain) errors.push_back(RodQuantityName(quantity));
      rods.push_back({{"motor", rod.motor},
                      {"from", tree.links[rod.from_link].name},
                      {"to", tree.links[rod.to_link].name},
                      {"length", rod.length},
                      {"errors", errors}});
    }
    linkages.push_back({{"name", linkage.name}, {"joints", joints}, {"rods", rods}});
  }
  return linkages;
}

/// Consequence for the user of axes that are nearly special, as text.
std::string DescribeNearly(const RobotTree& tree, const SpecialGeometry& group) {
  std::string names;
  for (int joint : group.joints) names += (names.empty() ? "" : ", ") + tree.joints[joint].name;
  const double off = Deviation(tree, group);
  const std::string meaning =
      "; are numbers of the robot description rounded? The estimate does not hinge on it, but "
      "inverse kinematics in closed form does";
  if (group.kind == SpecialGeometry::Kind::kSphericalWrist) {
    return fmt::format("the axes of {} nearly, but not exactly, meet in one point ({:.3g} mm)",
                       names, 1e3 * off) +
           meaning;
  }
  const double distance = AxisDistance(tree, group.joints[0], group.joints[1]);
  const bool one = distance < kNearlyOne;
  return fmt::format("the axes of {} are nearly, but not exactly, {} ({:.3g} deg{})", names,
                     one ? "one axis" : "parallel", off * 180.0 / M_PI,
                     one ? fmt::format(", {:.3g} mm", 1e3 * distance) : "") +
         meaning + ", and parameters that move one axis along or about the other are told badly" +
         " (QR counts them as identifiable)";
}

}  // namespace

RobotInspection InspectRobot(const Project& project, const InspectionOptions& options) {
  CheckHasMarkers(project);
  IdentifiabilityOptions identifiability = project.identifiability;
  if (options.seed) identifiability.seed = *options.seed;
  if (options.hold) identifiability.hold = *options.hold;
  identifiability.external = options.external;
  const bool free_root = project.recording.free_root;
  if (free_root) identifiability.root = RootPose::kFree;
  if (!identifiability.hold.empty()) {
    const ErrorModel all = MakeErrorModel(project.tree, project.markers, project.placement);
    CheckPatterns(all.parameters, identifiability.hold);
  }
  RobotInspection inspection{PlaceJoints(project.tree, project.placement),
                             {},
                             TotalMass(project.tree),
                             ProjectWarnings(project)};
  for (const Chain& chain : project.chains) {
    std::vector<Marker> markers = MarkersOf(project, chain);
    if (markers.empty()) continue;
    if (free_root) AddMarkersOf(project, project.tree.links[chain.from_link].body, markers);
    const RobotTree tree = Subtree(project.tree, chain.from_link);
    inspection.chains.push_back(InspectChain(
        chain.name, tree, SubtreeMarkers(project.tree, tree, markers), project, identifiability));
  }
  inspection.chains.push_back(
      InspectChain("(all markers)", project.tree, project.markers, project, identifiability));
  for (const ChainInspection& chain : inspection.chains) {
    if (chain.lost.empty()) continue;
    inspection.warnings.push_back(chain.name + ": special marker positions lose " +
                                  JoinNames(chain.model.parameters, chain.lost));
  }
  for (const SpecialGeometry& group : FindNearlySpecialGeometry(project.tree)) {
    inspection.warnings.push_back(DescribeNearly(project.tree, group));
  }
  return inspection;
}

std::string MakeInspectionJson(const Project& project, const RobotInspection& inspection) {
  Json chains = Json::array();
  for (const ChainInspection& chain : inspection.chains) chains.push_back(ChainJson(chain));
  const Json json = {{"robot", project.tree.name},
                     {"links", project.tree.links.size()},
                     {"joints", project.tree.joints.size()},
                     {"mass_kg", inspection.mass},
                     {"mdh", PlacementsJson(project.tree, inspection.placements)},
                     {"linkages", LinkagesJson(project.tree)},
                     {"chains", chains},
                     {"warnings", inspection.warnings}};
  return JsonText(json);
}

}  // namespace elastocal
