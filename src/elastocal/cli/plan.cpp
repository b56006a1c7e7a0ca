#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/plan_problem.hpp"
#include "elastocal/cli/report_page.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/io/output_files.hpp"
#include "elastocal/io/planned_motion_file.hpp"
#include "elastocal/io/truth_file.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/simulation/stand_through.hpp"

namespace elastocal::cli {
namespace {

using Json = nlohmann::ordered_json;

struct PlanCommand {
  CommonOptions common;
  std::string project, postures, output, trajectory, folder;
  std::string validation;
  int threads = 2;
  int tries = 0;
  double leg_errors = TruthOptions{}.leg_geometry_scale;
  double friction = 0.5;
  bool unbalanced = false, unstabilised = false;
  PlanOptions plan;
  MotionLimits limits;
};

std::vector<PostureTour> Sets(const Project& project, const StandingRobot& robot,
                              const PlanCommand& command) {
  if (command.validation.empty()) {
    return PostureTours(robot, ReadPostureFile(command.postures, project));
  }
  return ProjectValidationTours(project, robot, command.validation,
                                command.common.seed.value_or(1));
}

std::string SetTable(const std::vector<PostureTour>& sets, const std::vector<PlannedTour>& planned,
                     double rate_hz) {
  TextTable table({"chain", "given", "visited", "left out", "s"});
  for (std::size_t i = 0; i < planned.size(); ++i) {
    table.Add({planned[i].name, std::to_string(sets[i].postures.size() + sets[i].sines.size()),
               std::to_string(sets[i].postures.size() + sets[i].sines.size() -
                              planned[i].left_out.size()),
               std::to_string(planned[i].left_out.size()),
               fmt::format("{:.1f}", static_cast<double>(planned[i].motion.q.rows()) / rate_hz)});
  }
  return table.Render();
}

std::string WhatWasLeftOut(const Project& project, const PlannedTour& set, const LeftOut& left) {
  const std::string what =
      left.sine >= 0
          ? "sine of " + project.tree.joints[project.tree.coordinate_joint[left.sine]].name
          : fmt::format("posture {}", left.posture + 1);
  return fmt::format("{}, {} is left out: {} ({})", set.name, what, ReasonText(project, left),
                     left.at_rest ? "at rest" : "on every way there");
}

/// Plays the motion on robots with errors that stand free.
std::string TryTable(const Project& project, const JointMotion& motion, const PlanCommand& command,
                     Json& json) {
  const DescribedRobot described = DescribeRobot(project);
  const TrueRobot nominal =
      NominalRobot(described.tree, described.markers, FindLegs(described.tree, described.chains),
                   described.torque_sensors);
  TextTable table(
      {"robot", "stands s", "largest lean deg", "tracking deg", "zmp to edge mm", "shift mm"});
  for (int i = 1; i <= command.tries; ++i) {
    TruthOptions truth;
    truth.seed = command.common.seed.value_or(1) + static_cast<std::uint64_t>(i) - 1;
    truth.leg_geometry_scale = command.leg_errors;
    PhysicsOptions physics;
    physics.floor_friction = command.friction;
    Stabiliser stabiliser(project.tree, project.soles);
    const StandingRun run = StandThrough(DrawTrueRobot(nominal, truth), project.soles, motion,
                                         physics, command.unstabilised ? nullptr : &stabiliser);
    table.Add({std::to_string(truth.seed),
               fmt::format("{:.2f}{}", run.time_s, run.stood ? "" : " FELL"),
               fmt::format("{:.2f}", run.largest_lean * 180.0 / M_PI),
               fmt::format("{:.2f}", run.tracking * 180.0 / M_PI),
               fmt::format("{:.1f}", 1e3 * run.least_zmp_margin),
               fmt::format("{:.1f}", 1e3 * run.largest_shift)});
    json["tries"].push_back({{"seed", truth.seed},
                             {"stood", run.stood},
                             {"time_s", run.time_s},
                             {"largest_lean", run.largest_lean},
                             {"tracking", run.tracking},
                             {"least_zmp_margin", run.least_zmp_margin},
                             {"largest_shift", run.largest_shift}});
  }
  return table.Render();
}

Json MakeJson(const Project& project, const std::vector<PlannedTour>& planned,
              const MotionMargins& margins, double rate_hz, double seconds) {
  Json json;
  json["planning_s"] = seconds;
  json["sets"] = Json::array();
  for (const PlannedTour& set : planned) {
    Json one = {{"name", set.name},
                {"duration_s", static_cast<double>(set.motion.q.rows()) / rate_hz},
                {"visits", Json::array()},
                {"left_out", Json::array()}};
    for (const Visit& visit : set.visits) one["visits"].push_back(visit.posture);
    for (const LeftOut& left : set.left_out) {
      one["left_out"].push_back({{"posture", left.posture}, {"reason", ReasonText(project, left)}});
    }
    json["sets"].push_back(one);
  }
  json["margins"] = {
      {"clearance_m", margins.clearance.value}, {"zmp_m", margins.zmp.value},
      {"torque_share", margins.torque.value},   {"velocity_share", margins.velocity.value},
      {"friction", margins.friction.value},     {"foot_moved_m", margins.foot_moved.value}};
  return json;
}

/// Of each chain the part in which its feet stand, as a motion of its own.
std::vector<std::pair<std::filesystem::path, std::string>> ChainFiles(
    const Project& project, const std::vector<PlannedTour>& planned, const PlannedMotion& whole,
    const std::filesystem::path& folder) {
  std::vector<std::pair<std::filesystem::path, std::string>> files;
  Eigen::Index row = whole.motion.q.rows();
  for (const PlannedTour& tour : planned) row -= tour.motion.q.rows();
  for (const PlannedTour& tour : planned) {
    const Eigen::Index first = row + tour.begin, count = tour.end - tour.begin;
    const auto support = whole.motion.support.begin() + first;
    PlannedMotion part;
    part.motion.time_s =
        whole.motion.time_s.segment(first, count).array() - whole.motion.time_s[first];
    part.motion.q = whole.motion.q.middleRows(first, count);
    part.motion.support.assign(support, support + count);
    part.zmp = whole.zmp.middleRows(first, count);
    part.torques = whole.torques.middleRows(first, count);
    files.emplace_back(folder / (tour.name + ".csv"), FormatMotionTable(project.tree, part));
    row += tour.motion.q.rows();
  }
  return files;
}

int Plan(const PlanCommand& command) {
  const Project project = ReadProject(command.project);
  CheckOutputs({command.output, command.trajectory, command.common.json_file},
               {command.project, project.urdf, command.postures});
  const auto robot = StandProjectRobot(project, command.limits);
  const std::vector<PostureTour> sets = Sets(project, *robot, command);
  const auto begin = std::chrono::steady_clock::now();
  PlanOptions options = command.plan;
  options.balanced = !command.unbalanced;
  const std::vector<PlannedTour> planned = PlanTours(*robot, sets, options, command.threads);
  const SampledMotion motion = JoinMotions(*robot, planned, 5.0, options.rate_hz);
  MotionForces forces;
  const MotionMargins margins = CheckMotion(*robot, motion, &forces);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

  bool impossible = false;
  for (const PlannedTour& set : planned) {
    std::vector<std::string> warnings;
    for (const LeftOut& left : set.left_out) {
      warnings.push_back(WhatWasLeftOut(project, set, left));
    }
    PrintWarnings(warnings);
    impossible = impossible || set.motion.q.rows() == 0 ||
                 (set.visits.empty() && !set.left_out.empty() && set.left_out[0].posture >= 0);
  }
  const bool silent = command.common.Silent();
  Print(silent, SetTable(sets, planned, options.rate_hz));
  if (impossible) {
    PrintWarnings({"a chain has no posture that can be kept and reached: nothing is written"});
    return kNotConverged;
  }
  Print(silent, "\n" + MarginTable(project, margins, robot->limits, options.rate_hz) +
                    fmt::format("\n{:.1f} s of motion planned and checked in {:.1f} s\n",
                                static_cast<double>(motion.q.rows()) / options.rate_hz, seconds));
  const PlannedMotion result{ToJointMotion(*robot, motion), forces.zmp, forces.torques};
  WriteFile(command.output, FormatMotionTable(project.tree, result));
  if (!command.folder.empty()) WriteFiles(ChainFiles(project, planned, result, command.folder));
  if (!command.trajectory.empty()) {
    constexpr int kEvery = 5;  // 20 Hz
    WriteFile(command.trajectory, FormatJointTrajectory(project.tree, result.motion, kEvery));
  }
  Json json = MakeJson(project, planned, margins, options.rate_hz, seconds);
  if (command.tries > 0) {
    Print(silent, "\nPlayed by robots with errors that stand free\n" +
                      TryTable(project, result.motion, command, json));
  }
  Print(silent, fmt::format("\nWritten: {}\n", command.output));
  if (!command.common.json_file.empty()) {
    WriteFile(command.common.json_file, json.dump(2) + "\n");
  }
  const std::filesystem::path output(command.output);
  WriteFile(output.parent_path() / (output.stem().string() + "_margins.json"), json.dump(2) + "\n");
  std::vector<std::filesystem::path> inputs;
  if (!command.postures.empty()) inputs.push_back(command.postures);
  WritePlanningReport(output, "plan", command.common, project, inputs);
  const bool broken = !command.unbalanced && Broken(margins, robot->limits).has_value();
  return broken ? kNotConverged : kFine;
}

}  // namespace

void AddPlan(CLI::App& app, Action& action) {
  auto options = std::make_shared<PlanCommand>();
  CLI::App* command = app.add_subcommand(
      "plan", "Plan a motion through calibration postures that the robot does standing by itself");
  command->add_option("project", options->project, "Project file (YAML)")->required();
  auto* postures = command->add_option("--postures", options->postures,
                                       "Posture file (YAML; docs/formats.md), as design writes it");
  command
      ->add_option("--validation", options->validation,
                   "Plan a validation motion of all chains instead")
      ->check(CLI::IsMember({"sine", "random", "repeatability"}))
      ->excludes(postures);
  command->add_option("-o,--output", options->output, "Motion (CSV; docs/formats.md, Motion)")
      ->required();
  command->add_option("--trajectory", options->trajectory,
                      "Also as a ROS trajectory_msgs/JointTrajectory (YAML)");
  command->add_option("--chains", options->folder,
                      "Also a motion a chain in this folder, without the changes of support: what "
                      "simulate --motion plays as a trial");
  const auto number = [&](const char* name, double& value, const char* help) {
    command->add_option(name, value, help)->check(CLI::PositiveNumber)->capture_default_str();
  };
  number("--move-s", options->plan.path.duration_s, "Time between two postures, s");
  number("--hold-s", options->plan.hold_s, "At rest in each posture, s (at least 1)");
  number("--zmp-margin", options->limits.zmp_margin,
         "Least distance of the zero-moment point to the edge of the support, m");
  number("--torque-share", options->limits.torque_share, "Share of the torque limits to be used");
  number("--velocity-share", options->limits.velocity_share,
         "Share of the velocity limits to be used");
  number("--friction", options->friction, "Friction of the floor that --try plays on");
  command->add_option("--threads", options->threads, "Chains planned at a time")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command
      ->add_option("--try", options->tries,
                   "Play the motion on as many robots with errors, standing free")
      ->check(CLI::Range(0, 1000));
  number("--leg-errors", options->leg_errors, "Factor on the errors of their legs' geometry");
  command->add_flag("--no-stabiliser", options->unstabilised,
                    "They follow the motion blindly: nothing corrects it by what the feet and the "
                    "inertial unit feel");
  command->add_flag("--unbalanced", options->unbalanced, "Do not balance, to see what comes of it");
  AddCommonOptions(*command, options->common);
  command->footer(
      "Example: elastocal plan models/talos/project.yaml --postures postures.yaml -o motion.csv");
  command->callback([&action, options] {
    if (options->postures.empty() && options->validation.empty()) {
      throw CLI::RequiredError("--postures or --validation");
    }
    action = [options] { return Plan(*options); };
  });
}

}  // namespace elastocal::cli
