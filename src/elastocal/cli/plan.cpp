// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/option_checks.hpp"
#include "elastocal/cli/report_page.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/result_folder.hpp"
#include "elastocal/planning/leave_room.hpp"
#include "elastocal/planning/plan_motion.hpp"

namespace elastocal::cli {
namespace {

struct PlanCommand {
  CommonOptions common;
  std::string project, postures, output, trajectory, folder;
  std::string kind;  ///< kind of a validation motion; empty: postures are given
  std::optional<double> zmp_margin_mm, lift_mm, inset_mm, approach_mm;
  std::string ros = "2";  ///< version of ROS for the stamps of the trajectory
  bool unbalanced = false, unstabilised = false;
  std::optional<double> limit_margin_deg;
  MotionPlanOptions options;
  MotionTrialOptions tries{.robots = 0};
};

std::string SetTable(const MotionPlan& plan) {
  TextTable table({"chain", "given", "visited", "left out", "s"});
  for (std::size_t i = 0; i < plan.planned.size(); ++i) {
    const PlannedTour& planned = plan.planned[i];
    const std::size_t given = plan.sets[i].postures.size() + plan.sets[i].sines.size();
    table.Add({planned.name, std::to_string(given), std::to_string(given - planned.left_out.size()),
               std::to_string(planned.left_out.size()),
               fmt::format("{:.1f}", static_cast<double>(planned.motion.q.rows()) / plan.rate_hz)});
  }
  return table.Render();
}

std::string LimitTable(const std::vector<LimitUse>& limits) {
  TextTable table({"over all samples", "worst", "limit", "at s", "where"});
  for (const LimitUse& use : limits) {
    table.Add({use.what, use.worst, use.limit, fmt::format("{:.2f}", use.time_s), use.where});
  }
  return table.Render();
}

std::string TryTable(const std::vector<MotionTrial>& trials) {
  TextTable table(
      {"robot", "stands s", "largest lean deg", "tracking deg", "zmp to edge mm", "shift mm"});
  for (const auto& [seed, run] : trials) {
    table.Add({std::to_string(seed), fmt::format("{:.2f}{}", run.time_s, run.stood ? "" : " FELL"),
               fmt::format("{:.2f}", run.largest_lean * 180.0 / M_PI),
               fmt::format("{:.2f}", run.tracking * 180.0 / M_PI),
               fmt::format("{:.1f}", 1e3 * run.least_zmp_margin),
               fmt::format("{:.1f}", 1e3 * run.largest_shift)});
  }
  return table.Render();
}

ValidationKind KindNamed(const std::string& name) {
  return name == "sine"     ? ValidationKind::kSine
         : name == "random" ? ValidationKind::kRandom
                            : ValidationKind::kRepeatability;
}

/// Prints as errors why the motion must not be played. Returns whether there is a reason.
bool Refuse(const MotionPlan& plan, bool unbalanced) {
  for (const std::string& chain : plan.impossible) {
    spdlog::error("chain '{}' has no posture that can be kept and reached", chain);
  }
  const std::vector<LimitUse> broken = plan.broken();
  for (const LimitUse& use : broken) {
    if (unbalanced) {
      spdlog::warn("not balanced, the motion breaks a limit: {}", use.Describe());
    } else if (plan.impossible.empty()) {
      spdlog::error("the motion breaks a limit: {}", use.Describe());
    }
  }
  const bool refused = !plan.impossible.empty() || (!broken.empty() && !unbalanced);
  if (refused) spdlog::error("no motion is written");
  return refused;
}

/// Converts the options; lengths on the command line are in mm.
MotionPlanOptions PlanOptions(const PlanCommand& command) {
  MotionPlanOptions options = command.options;
  if (command.zmp_margin_mm) options.limits.zmp_margin = 1e-3 * *command.zmp_margin_mm;
  if (command.lift_mm) options.plan.lift_m = 1e-3 * *command.lift_mm;
  if (command.inset_mm) options.plan.inset = 1e-3 * *command.inset_mm;
  if (command.approach_mm) options.approach.height = 1e-3 * *command.approach_mm;
  options.plan.balanced = !command.unbalanced;
  return options;
}

MotionTrialOptions TrialOptions(const PlanCommand& command) {
  MotionTrialOptions options = command.tries;
  options.seed = command.common.seed.value_or(1);
  options.stabilised = !command.unstabilised;
  options.threads = command.options.threads;
  return options;
}

void PrintPlan(const Project& project, const MotionPlan& plan, const CommonOptions& common) {
  PrintWarnings(plan.left_out, common.verbose);
  PrintWarnings(plan.beyond_ranges, common.verbose);
  const bool quiet = common.Silent();
  if (project.soles.empty()) {
    Print(quiet, "The project has no soles: the root link is held still, nothing is balanced\n\n");
  }
  Print(quiet, SetTable(plan));
  if (plan.impossible.empty()) {
    Print(quiet, "\n" + LimitTable(plan.limits) +
                     fmt::format("\n{:.1f} s of motion planned and checked in {:.1f} s\n",
                                 static_cast<double>(plan.whole.motion.q.rows()) / plan.rate_hz,
                                 plan.seconds));
  }
}

/// Refuses --approach-mm where no touch is planned and it would have no effect.
void RefuseIdleApproach(const PlanCommand& command, const Project& project) {
  if (command.approach_mm && (!project.contact || !command.kind.empty())) {
    throw InputError(
        "--approach-mm: it is for --postures with touches, which only a project with "
        "contact has; " +
        project.file.string() + " has none, or --kind is given");
  }
}

int Plan(const PlanCommand& command) {
  const Project described = ReadProject(command.project);
  RefuseIdleApproach(command, described);
  const MotionTrialOptions tries = TrialOptions(command);
  CheckTries(described, tries);
  const Project project = WithRoom(described, command.limit_margin_deg);
  std::vector<ChainPostures> postures;
  std::vector<std::string> chains;
  if (command.kind.empty()) {
    postures = ReadPostureFile(command.postures, described);
    for (const ChainPostures& chain : postures) chains.push_back(chain.chain);
  } else {
    chains = ValidationChains(project);
  }
  MotionFiles files(command.output);
  files.trajectory = command.trajectory;
  files.ros = command.ros == "1" ? RosVersion::kRos1 : RosVersion::kRos2;
  if (!command.folder.empty()) files.AddChains(command.folder, chains);
  OutputSet outputs;
  std::vector<std::filesystem::path> inputs = {command.project, project.urdf};
  if (!command.postures.empty()) inputs.emplace_back(command.postures);
  outputs.Protect(inputs);
  files.Declare(project.tree, outputs);
  DeclarePlanningReport(command.output, outputs);
  DeclareJson(command.common.json_file, outputs);
  outputs.Prepare();

  const bool quiet = command.common.Silent();
  const Progress progress = LoggedProgress("planned chain", quiet);
  const MotionPlanOptions options = PlanOptions(command);
  MotionPlan plan = command.kind.empty() ? PlanMotion(project, postures, options, progress)
                                         : PlanValidationMotion(project, KindNamed(command.kind),
                                                                tries.seed, options, progress);
  CountToOwnLimits(described, project, options, plan);
  PrintPlan(project, plan, command.common);
  if (Refuse(plan, command.unbalanced)) return kNotConverged;

  const std::vector<MotionTrial> trials =
      TryMotion(project, plan.whole.motion, tries, LoggedProgress("robot", quiet));
  if (!trials.empty()) {
    Print(quiet, "\nPlayed by robots with errors that stand free\n" + TryTable(trials));
  }
  SetMotionFiles(files, project, plan, trials, outputs);
  outputs.Set(command.common.json_file, FormatMotionSummary(project, plan, trials));
  const PlanningReport report =
      SetPlanningReport(command.output, MakeRunRecord("plan", command.common, RecordInputs(inputs)),
                        project, outputs);
  outputs.Publish();
  Print(quiet, fmt::format("\nWritten: {}\n", command.output));
  PrintWarnings(report.warnings, command.common.verbose);
  PrintReportPlace(report.folder, report.why_none, quiet);
  const auto fell = std::count_if(trials.begin(), trials.end(),
                                  [](const MotionTrial& trial) { return !trial.run.stood; });
  if (fell > 0) spdlog::error("{} of {} robots fell", fell, trials.size());
  return fell > 0 ? kNotConverged : kFine;
}

CLI::Option* AddNumber(CLI::App& command, const std::string& name, double& value,
                       const char* help) {
  return command.add_option(name, value, help)
      ->check(InBounds("plan " + name))
      ->capture_default_str();
}

/// Adds an option for a length; without it, the robot's size determines the value.
void AddLength(CLI::App& command, const std::string& name, std::optional<double>& value,
               const char* help) {
  command.add_option(name, value, help)->check(InBounds("plan " + name));
}

/// Adds options that select postures or a motion.
void AddWhat(CLI::App& command, PlanCommand& options) {
  auto* postures = command
                       .add_option("--postures", options.postures,
                                   "Posture file (YAML; docs/formats.md), as design writes it")
                       ->type_name("FILE");
  command
      .add_option("--kind", options.kind,
                  "Plan a validation motion of this kind, of all chains, instead")
      ->transform(OneOf({"sine", "random", "repeatability"}))
      ->excludes(postures);
  command
      .add_option("--count", options.options.validation.random_postures,
                  "Postures of each chain, of --kind random")
      ->check(FromTo(1, 1000))
      ->excludes(postures)
      ->capture_default_str();
}

void AddFiles(CLI::App& command, PlanCommand& options) {
  command.add_option("-o,--output", options.output, "Motion (CSV; docs/formats.md, Motion)")
      ->required()
      ->check(IsNamed)
      ->type_name("FILE");
  auto* trajectory =
      command
          .add_option("--trajectory", options.trajectory,
                      "Also as a ROS trajectory_msgs/JointTrajectory (YAML) of the joints of all "
                      "chains, and of others that move")
          ->type_name("FILE");
  command
      .add_option("--ros", options.ros,
                  "Stamps of the trajectory: sec and nanosec (2), or secs and nsecs (1)")
      ->transform(OneOf({"1", "2"}))
      ->needs(trajectory)
      ->capture_default_str();
  command
      .add_option("--per-chain", options.folder,
                  "Also a motion for each chain in this folder, without the changes of support: "
                  "what simulate --motion plays as a trial")
      ->type_name("DIR");
}

/// Adds times and limits of the motion.
void AddLimits(CLI::App& command, PlanCommand& options) {
  MotionPlanOptions& plan = options.options;
  AddNumber(command, "--move-s", plan.plan.path.duration_s, "Time between two postures, s");
  AddNumber(command, "--rest-s", plan.plan.hold_s, "At rest in each posture, s");
  AddLength(
      command, "--zmp-margin-mm", options.zmp_margin_mm,
      "Least distance of the zero-moment point to the edge of the support, mm; default: 0.3 of "
      "half the width of the sole");
  AddLength(
      command, "--lift-mm", options.lift_mm,
      "Height to which a foot is lifted before its leg moves freely, mm; default: 0.123 of the "
      "leg's length");
  AddLength(command, "--inset-mm", options.inset_mm,
            "How far the zero-moment point stays from the middle of a sole, towards the foot that "
            "leaves or meets the floor, mm; default: 0.54 of half the width of the sole");
  AddLength(
      command, "--approach-mm", options.approach_mm,
      "Of touches: height above its table from which a plate goes straight down, mm; default: 50");
  command
      .add_option("--torque-share", plan.torque_share,
                  "Share of the torque limits to be used; default: design.motion_effort_share of "
                  "the project, which is 0.9 where it is not given")
      ->check(InBounds("plan --torque-share"));
  AddNumber(command, "--velocity-share", plan.limits.velocity_share,
            "Share of the velocity limits to be used");
  command
      .add_option("--limit-margin-deg", options.limit_margin_deg,
                  "Left free at either end of the limits of turning joints, deg, at most a tenth "
                  "of a range: room for `compensate`; default: design.room_deg of the project, "
                  "which is 0 where it is not given")
      ->check(InBounds("plan --limit-margin-deg"));
}

/// Adds options for robots that play the motion, and for balance.
void AddRobots(CLI::App& command, PlanCommand& options) {
  command
      .add_option("--threads", options.options.threads,
                  "Chains planned, and robots tried, at a time")
      ->check(FromTo(1, 64))
      ->capture_default_str();
  CLI::Option* robots =
      command
          .add_option("--robots", options.tries.robots,
                      "Play the motion on as many robots with errors, standing free")
          ->check(FromTo(0, 1000));
  AddNumber(command, "--floor-friction", options.tries.floor_friction,
            "Friction of the floor that --robots stand on")
      ->needs(robots);
  AddNumber(command, "--leg-geometry-scale", options.tries.leg_errors,
            "Factor on the errors of the legs' geometry of --robots")
      ->needs(robots);
  command
      .add_flag("--no-stabiliser", options.unstabilised,
                "The --robots follow the motion blindly: nothing corrects it by what the feet and "
                "the inertial unit feel")
      ->needs(robots);
  command.add_flag("--no-balance", options.unbalanced,
                   "Do not balance, to see what comes of it: the motion is written although it "
                   "breaks its limits");
}

}  // namespace

void AddPlan(CLI::App& app, Action& action) {
  auto options = std::make_shared<PlanCommand>();
  CLI::App* command = app.add_subcommand(
      "plan", "Plan a motion through calibration postures that the robot does standing by itself");
  command->add_option("project", options->project, "Project file (YAML)")->required();
  AddWhat(*command, *options);
  AddFiles(*command, *options);
  AddLimits(*command, *options);
  AddRobots(*command, *options);
  AddCommonOptions(*command, options->common);
  command->footer(
      "Example: elastocal plan models/talos/project.yaml --postures postures.yaml -o motion.csv");
  command->callback([&action, options, command] {
    if (options->postures.empty() && options->kind.empty()) {
      throw CLI::RequiredError("--postures or --kind");
    }
    if (command->count("--count") > 0 && options->kind != "random") {
      throw CLI::RequiresError("--count", "--kind random");
    }
    action = [options] { return Plan(*options); };
  });
}

}  // namespace elastocal::cli
