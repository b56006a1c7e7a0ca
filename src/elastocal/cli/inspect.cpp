// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/option_checks.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/pipeline/inspect_robot.hpp"
#include "elastocal/pipeline/result_folder.hpp"
#include "elastocal/robot/parameter_names.hpp"

namespace elastocal::cli {
namespace {

struct InspectOptions {
  CommonOptions common;
  std::string project, external = "first";
  std::vector<std::string> hold;
  bool regrouping = false;
};

constexpr double kDegreesPerRadian = 180.0 / M_PI;

/// A number with `digits` decimals, without the minus of a zero.
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
    table.Add({joint.name, parent, p.general ? Fixed(p.gamma * kDegreesPerRadian, 3) : "",
               p.general ? Fixed(1e3 * p.b, 3) : "",
               p.parallel ? Fixed(p.beta * kDegreesPerRadian, 3) : "",
               Fixed(p.alpha * kDegreesPerRadian, 3), Fixed(1e3 * p.d, 3),
               Fixed(p.theta * kDegreesPerRadian, 3), Fixed(1e3 * p.r, 3)});
  }
  return table.Render();
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

/// Table of linkages: which motor moves which joints by which rod, and the positions of the motors
/// in the assembled linkage.
std::string LinkageTable(const RobotTree& tree) {
  TextTable table(
      {"linkage", "joints", "motor", "from", "to", "length mm", "assembled at", "errors"});
  for (const Linkage& linkage : tree.linkages) {
    std::string joints;
    for (int k : linkage.joints) joints += (joints.empty() ? "" : ", ") + tree.joints[k].name;
    const auto motors = MotorPositions(tree, linkage, linkage.assembled);
    for (std::size_t i = 0; i < linkage.rods.size(); ++i) {
      const Rod& rod = linkage.rods[i];
      const double at = motors ? (*motors)[static_cast<Eigen::Index>(i)] : 0.0;
      table.Add(
          {i == 0 ? linkage.name : "", i == 0 ? joints : "", rod.motor,
           tree.links[rod.from_link].name, tree.links[rod.to_link].name, Fixed(1e3 * rod.length, 3),
           rod.actuator ? Fixed(1e3 * at, 3) + " mm" : Fixed(at * kDegreesPerRadian, 3) + " deg",
           std::to_string(rod.uncertain.size())});
    }
  }
  return table.Render();
}

std::string CountTable(const std::vector<ChainInspection>& chains) {
  TextTable table({"chain", "joints", "markers", "parameters", "held", "identifiable", "4R+2P+3N_M",
                   "smallest kept", "largest dropped"});
  for (const ChainInspection& chain : chains) {
    table.Add({chain.name, std::to_string(chain.joints), std::to_string(chain.model.marker_count()),
               std::to_string(chain.model.parameter_count()),
               std::to_string(chain.base.held.size()), std::to_string(chain.base.geometric_count),
               std::to_string(chain.base.theoretical_count),
               fmt::format("{:.1e}", chain.base.smallest_kept),
               fmt::format("{:.1e}", chain.base.largest_dropped)});
  }
  return table.Render();
}

std::string RegroupingText(const ChainInspection& chain) {
  std::string text;
  const auto& parameters = chain.model.parameters;
  for (std::size_t d = 0; d < chain.base.dropped.size(); ++d) {
    text += "  " + parameters[chain.base.dropped[d]].name + " ->";
    for (const Share& share : RegroupedInto(chain.base, static_cast<int>(d))) {
      text += fmt::format(" {:+.4g} {}", share.coefficient, parameters[share.parameter].name);
    }
    text += "\n";
  }
  return text;
}

void PrintInspection(const Project& project, const RobotInspection& inspection,
                     const InspectOptions& options) {
  const bool quiet = options.common.Silent();
  Print(quiet,
        fmt::format("Robot {}: {} links, {} movable joints, {:.3f} kg\n\n", project.tree.name,
                    project.tree.links.size(), project.tree.joints.size(), inspection.mass));
  Print(quiet,
        "Modified Denavit-Hartenberg constants (eq. 1; gamma and b after the waist and after "
        "branches)\n" +
            MdhTable(project.tree, inspection.placements));
  Print(quiet, "\nParallel consecutive axes (beta in use)\n" +
                   ParallelAxes(project.tree, inspection.placements));
  if (!project.tree.linkages.empty()) {
    Print(quiet, "\nLinkages (motors are recorded; joints follow by the rods)\n" +
                     LinkageTable(project.tree));
  }
  Print(quiet, "\nIdentifiable parameters" +
                   std::string(project.recording.free_root
                                   ? " (root free: its markers with each chain's, 6 fewer)\n"
                                   : "\n") +
                   CountTable(inspection.chains));
  for (const ChainInspection& chain : inspection.chains) {
    Print(quiet, fmt::format("\n{}: not identifiable beside the others: {}\n", chain.name,
                             JoinNames(chain.model.parameters, chain.base.dropped)));
    if (options.regrouping) Print(quiet, RegroupingText(chain));
  }
  PrintWarnings(inspection.warnings, options.common.verbose);
}

int Inspect(const InspectOptions& options) {
  const Project project = ReadProject(options.project);
  OutputSet outputs;
  outputs.Protect({options.project, project.urdf});
  DeclareJson(options.common.json_file, outputs);
  outputs.Prepare();
  InspectionOptions inspect;
  if (!options.hold.empty()) inspect.hold = options.hold;
  if (options.external == "last") inspect.external = ExternalPriority::kLast;
  inspect.seed = options.common.seed;
  const RobotInspection inspection = InspectRobot(project, inspect);
  outputs.Set(options.common.json_file, MakeInspectionJson(project, inspection));
  outputs.Publish();
  PrintInspection(project, inspection, options);
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
      ->transform(OneOf({"first", "last"}))
      ->capture_default_str();
  command->add_flag("--regrouping", options->regrouping,
                    "Show what each dropped parameter is regrouped into");
  AddCommonOptions(*command, options->common);
  command->footer("Example: elastocal inspect models/talos/project.yaml --regrouping");
  command->callback([&action, options] { action = [options] { return Inspect(*options); }; });
}

}  // namespace elastocal::cli
