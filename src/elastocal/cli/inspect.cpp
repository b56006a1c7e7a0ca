#include <cmath>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/io/output_files.hpp"
#include "elastocal/robot/statics.hpp"
#include "elastocal/robot/subtree.hpp"

namespace elastocal::cli {
namespace {

using Json = nlohmann::ordered_json;

struct InspectOptions {
  CommonOptions common;
  std::string project, external = "first";
  std::vector<std::string> hold;
  bool regrouping = false;
};

constexpr double kDegrees = 180.0 / M_PI;

/// Without the minus of a negative zero and of what rounds to zero.
std::string Fixed(double value, int digits) {
  const std::string text = fmt::format("{:.{}f}", value, digits);
  return text.find_first_not_of("-0.") == std::string::npos && text[0] == '-' ? text.substr(1)
                                                                              : text;
}

std::string MdhTable(const RobotTree& tree, const std::vector<JointPlacement>& placements) {
  TextTable table({"joint", "after", "gamma deg", "b mm", "beta deg", "alpha deg", "d mm",
                   "theta deg", "r mm"});
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    const Joint& joint = tree.joints[k];
    const JointPlacement& p = placements[k];
    const std::string parent =
        joint.parent_body == 0 ? "waist" : tree.joints[joint.parent_body - 1].name;
    table.Add({joint.name, parent, p.general ? Fixed(p.gamma * kDegrees, 3) : "",
               p.general ? Fixed(1e3 * p.b, 3) : "", p.parallel ? Fixed(p.beta * kDegrees, 3) : "",
               Fixed(p.alpha * kDegrees, 3), Fixed(1e3 * p.d, 3), Fixed(p.theta * kDegrees, 3),
               Fixed(1e3 * p.r, 3)});
  }
  return table.Render();
}

Json MdhJson(const RobotTree& tree, const std::vector<JointPlacement>& placements) {
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

std::string ParallelAxes(const RobotTree& tree, const std::vector<JointPlacement>& placements) {
  std::string text;
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    if (!placements[k].parallel) continue;
    text += fmt::format("  {} / {}\n", tree.joints[tree.joints[k].parent_body - 1].name,
                        tree.joints[k].name);
  }
  return text.empty() ? "  none\n" : text;
}

/// What is identifiable of one chain.
struct ChainReport {
  std::string name;
  int joints = 0;
  ErrorModel model;
  BaseParameters base;
  std::vector<int> lost;  // by special marker positions
};

ChainReport InspectChain(const std::string& name, const RobotTree& tree,
                         const std::vector<Marker>& markers, const Project& project,
                         IdentifiabilityOptions options) {
  ChainReport report{name, 0, MakeErrorModel(tree, markers, project.placement), {}, {}};
  report.joints = static_cast<int>(report.model.active_joints.size());
  report.base = FindBaseParameters(report.model, options);
  if (report.base.geometric_count < report.base.theoretical_count && options.hold.empty()) {
    report.lost = LostBySpecialMarkers(report.model, options);
  }
  return report;
}

std::vector<ChainReport> InspectChains(const Project& project,
                                       const IdentifiabilityOptions& options) {
  std::vector<ChainReport> reports;
  for (const Chain& chain : project.chains) {
    std::vector<Marker> markers;
    for (const std::string& name : ChainMarkers(project, chain)) {
      for (const Marker& marker : project.markers) {
        if (marker.name == name) markers.push_back(marker);
      }
    }
    if (markers.empty()) continue;
    const RobotTree tree = Subtree(project.tree, chain.from_link);
    reports.push_back(InspectChain(chain.name, tree, SubtreeMarkers(project.tree, tree, markers),
                                   project, options));
  }
  reports.push_back(InspectChain("(all markers)", project.tree, project.markers, project, options));
  return reports;
}

std::string CountTable(const std::vector<ChainReport>& reports) {
  TextTable table({"chain", "joints", "markers", "parameters", "held", "identifiable", "4R+2P+3N_M",
                   "smallest kept", "largest dropped"});
  for (const ChainReport& report : reports) {
    table.Add(
        {report.name, std::to_string(report.joints), std::to_string(report.model.marker_count()),
         std::to_string(report.model.parameter_count()), std::to_string(report.base.held.size()),
         std::to_string(report.base.geometric_count), std::to_string(report.base.theoretical_count),
         fmt::format("{:.1e}", report.base.smallest_kept),
         fmt::format("{:.1e}", report.base.largest_dropped)});
  }
  return table.Render();
}

std::string RegroupingText(const ChainReport& report) {
  std::string text;
  const auto& parameters = report.model.parameters;
  for (std::size_t d = 0; d < report.base.dropped.size(); ++d) {
    text += "  " + parameters[report.base.dropped[d]].name + " ->";
    for (const Share& share : RegroupedInto(report.base, static_cast<int>(d))) {
      text += fmt::format(" {:+.4g} {}", share.coefficient, parameters[share.parameter].name);
    }
    text += "\n";
  }
  return text;
}

Json ChainJson(const ChainReport& report) {
  const auto names = [&](const std::vector<int>& which) {
    Json list = Json::array();
    for (int i : which) list.push_back(report.model.parameters[i].name);
    return list;
  };
  Json regrouping = Json::object();
  for (std::size_t d = 0; d < report.base.dropped.size(); ++d) {
    Json into = Json::object();
    for (const Share& share : RegroupedInto(report.base, static_cast<int>(d))) {
      into[report.model.parameters[share.parameter].name] = share.coefficient;
    }
    regrouping[report.model.parameters[report.base.dropped[d]].name] = into;
  }
  return {{"chain", report.name},
          {"joints", report.joints},
          {"markers", report.model.marker_count()},
          {"parameters", report.model.parameter_count()},
          {"identifiable", report.base.geometric_count},
          {"identifiable_theory", report.base.theoretical_count},
          {"smallest_kept", report.base.smallest_kept},
          {"largest_dropped", report.base.largest_dropped},
          {"held", names(report.base.held)},
          {"kept", names(report.base.kept)},
          {"dropped_regrouped_into", regrouping},
          {"lost_by_special_markers", names(report.lost)}};
}

int Inspect(const InspectOptions& options) {
  const Project project = ReadProject(options.project);
  CheckOutputs({options.common.json_file}, {options.project, project.urdf});
  IdentifiabilityOptions identifiability = project.identifiability;
  if (options.common.seed) identifiability.seed = *options.common.seed;
  if (!options.hold.empty()) identifiability.hold = options.hold;
  identifiability.external =
      options.external == "last" ? ExternalPriority::kLast : ExternalPriority::kFirst;
  if (!identifiability.hold.empty()) {
    const ErrorModel all = MakeErrorModel(project.tree, project.markers, project.placement);
    CheckPatterns(all.parameters, identifiability.hold);
  }

  const std::vector<JointPlacement> placements = PlaceJoints(project.tree, project.placement);
  const std::vector<ChainReport> reports = InspectChains(project, identifiability);
  const bool quiet = options.common.Silent();
  Print(quiet, fmt::format("Robot {}: {} links, {} movable joints, {:.3f} kg\n\n",
                           project.tree.name, project.tree.links.size(), project.tree.joints.size(),
                           TotalMass(project.tree)));
  Print(quiet,
        "Modified Denavit-Hartenberg constants (eq. 1; gamma and b after the waist and after "
        "branches)\n" +
            MdhTable(project.tree, placements));
  Print(quiet,
        "\nParallel consecutive axes (beta in use)\n" + ParallelAxes(project.tree, placements));
  Print(quiet, "\nIdentifiable parameters\n" + CountTable(reports));
  std::vector<std::string> warnings;
  Json chains = Json::array();
  for (const ChainReport& report : reports) {
    if (!report.lost.empty()) {
      warnings.push_back(report.name + ": special marker positions lose " +
                         JoinNames(report.model.parameters, report.lost));
    }
    Print(quiet, fmt::format("\n{}: not identifiable beside the others: {}\n", report.name,
                             JoinNames(report.model.parameters, report.base.dropped)));
    if (options.regrouping) Print(quiet, RegroupingText(report));
    chains.push_back(ChainJson(report));
  }
  PrintWarnings(warnings);
  if (!options.common.json_file.empty()) {
    const Json json = {{"robot", project.tree.name},
                       {"links", project.tree.links.size()},
                       {"joints", project.tree.joints.size()},
                       {"mass_kg", TotalMass(project.tree)},
                       {"mdh", MdhJson(project.tree, placements)},
                       {"chains", chains},
                       {"warnings", warnings}};
    WriteFile(options.common.json_file, json.dump(2) + "\n");
  }
  return kFine;
}

}  // namespace

void AddInspect(CLI::App& app, Action& action) {
  auto options = std::make_shared<InspectOptions>();
  CLI::App* command =
      app.add_subcommand("inspect", "Show the robot's DH constants and what can be identified");
  command->add_option("project", options->project, "Project file (YAML)")->required();
  command
      ->add_option("--hold", options->hold,
                   "Hold these parameters at nominal instead of the project's (name patterns with "
                   "*, such as 'waist.T0.*')")
      ->expected(-1);
  command
      ->add_option("--external", options->external,
                   "Whether waist and marker positions come before the joints' parameters (first) "
                   "or after them, as printed in the paper (last)")
      ->check(CLI::IsMember({"first", "last"}))
      ->capture_default_str();
  command->add_flag("--regrouping", options->regrouping,
                    "Show what each dropped parameter is regrouped into");
  AddCommonOptions(*command, options->common);
  command->footer("Example: elastocal inspect models/talos/project.yaml --regrouping");
  command->callback([&action, options] { action = [options] { return Inspect(*options); }; });
}

}  // namespace elastocal::cli
