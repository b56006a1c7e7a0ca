// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/correction_limits.hpp"
#include "elastocal/cli/execution_report.hpp"
#include "elastocal/cli/option_checks.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/io/motion_file.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/calibrated_robot.hpp"
#include "elastocal/pipeline/result_folder.hpp"
#include "elastocal/planning/compensate_motion.hpp"
#include "elastocal/planning/planned_motion_file.hpp"
#include "elastocal/runtime/core_equations.h"

namespace elastocal::cli {
namespace {

struct CompensateOptions {
  CommonOptions common;
  std::string calibration, project, motion, output;
  std::string as = "compensated", loads = "statics";
  double most_left_mm = 1e3 * CompensateMotionOptions{}.most_left_m;
  double most_turned_deg = CompensateMotionOptions{}.most_turned_rad * 180.0 / M_PI;
  double ease_s = 0.0;
  CorrectionLimits limits;
};

/// What a degree of attitude counts at the end of a limb: of an arm with too few joints, and of any
/// other.
std::string DegreeOfFew() { return fmt::format("{:.1f} mm", DegreeAsMillimetres(EC_ARM_OF_FEW)); }
// What deflects the robot and is in no expected error.
constexpr const char* kFastSprings = "Springs in fast motion";
constexpr const char* kAllSprings =
    "All deflections by springs, which '--as compensated' corrects,";

std::string Degree() { return fmt::format("{:.1f} mm", DegreeAsMillimetres(EC_ARM)); }

/// Table by limb, if any limb that does not yield has a deviation.
std::string DescribeLeft(const CompensatedMotion& result) {
  if (std::none_of(result.left.begin(), result.left.end(),
                   [](const LeftAtLimb& one) { return !one.yields && one.samples > 0; })) {
    return "";
  }
  const Eigen::VectorXd& time_s = result.planned.motion.time_s;
  const Eigen::Index last = result.planned.motion.q.rows() - 1;
  const bool timed = time_s.size() > 1;
  const double period = timed ? (time_s[last] - time_s[0]) / static_cast<double>(last) : 1.0;
  TextTable table(
      {"left at the end of", "most, mm", "at s", "most, deg",
       fmt::format("{} above {} mm", timed ? "seconds" : "samples", 1e3 * kLeftOver_m)});
  for (const LeftAtLimb& one : result.left) {
    table.Add({one.limb + (one.yields        ? " (yields)"
                           : one.place_first ? " (place first)"
                                             : ""),
               fmt::format("{:.2f}", 1e3 * one.most.value), fmt::format("{:.2f}", one.most.time_s),
               fmt::format("{:.2f}", one.most_turned.value * 180.0 / M_PI),
               fmt::format("{:.{}f}", period * one.samples, timed ? 2 : 0)});
  }
  const bool any_place_first = std::ranges::any_of(result.left, &LeftAtLimb::place_first);
  return table.Render() + "A degree counts " + Degree() +
         ". (yields): fewer than six joints, which cannot correct all\n" +
         (any_place_first
              ? "(place first): too few joints for place and attitude; a degree counts " +
                    DegreeOfFew() + "\n\n"
              : "\n");
}

/// Expected errors because the calibration does not know the geometry better; they are in none of
/// the other figures. `elastic`: whether deflections are corrected.
std::string DescribeExpected(const std::vector<ExpectedAtLimb>& expected, bool from_foot,
                             bool elastic) {
  if (expected.empty()) {
    return "How far the real robot will be from that is not known: the calibration has no "
           "covariance\n";
  }
  TextTable table({"expected on the robot, rms", "mm", "deg"});
  for (const ExpectedAtLimb& one : expected) {
    table.Add({one.limb, fmt::format("{:.1f}", 1e3 * one.position),
               fmt::format("{:.2f}", one.attitude * 180.0 / M_PI)});
  }
  const std::string of_all =
      ": what the calibration does not know of the geometry. A single robot may have\ntwice as "
      "much. ";
  if (!from_foot) {
    return "\n" + table.Render() + "Seen from the root link" + of_all +
           (elastic ? kFastSprings : kAllSprings) +
           " come on top. Measured places of markers on hands and root\nlink "
           "make it less (calibrate --marker-places)\n";
  }
  return "\n" + table.Render() + "Seen from the standing foot" + of_all +
         (elastic ? kFastSprings : kAllSprings) +
         " and a stabiliser come on top. Measured places of markers on "
         "hands,\nfeet and waist make it less (calibrate --marker-places), and so does a floor "
         "whose level is known\nbetter (calibration: {floor_tilt_deg: ...})\n";
}

std::string DescribeCompensation(const CompensatedMotion& result, const Project& project,
                                 bool elastic) {
  TextTable table({"over all samples", "worst", "at s", "where"});
  const auto add = [&](const char* what, const MotionExtreme& at, double scale) {
    table.Add({what, fmt::format("{:.2f}", scale * at.value), fmt::format("{:.2f}", at.time_s),
               at.where});
  };
  constexpr double kDegreesARadian = 180.0 / M_PI;
  const auto add_of_joint = [&](const char* what, const MotionExtreme& at) {
    const bool slides = std::ranges::any_of(project.tree.joints, [&](const Joint& joint) {
      return joint.name == at.where && joint.type == JointType::kPrismatic;
    });
    add((what + std::string(slides ? ", mm" : ", deg")).c_str(), at,
        slides ? 1e3 : kDegreesARadian);
  };
  add_of_joint("change of a joint", result.correction);
  add_of_joint("joint to its limit", result.position);
  add("velocity, % of limit", result.velocity, 100.0);
  if (result.has_clearance) add("least distance of parts, mm", result.clearance, 1e3);
  if (result.has_zmp) {
    add("zero-moment point to the edge, mm: plan", result.planned_zmp, 1e3);
    add("zero-moment point to the edge, mm: corrected", result.zmp, 1e3);
  }
  return table.Render() + DescribeOpenJoints(result.at_rest) + DescribeLeft(result) +
         fmt::format(
             "Left at the ends of limbs of the calibrated model (but for those that yield): at "
             "most {:.3f} mm and {:.4f} deg\n",
             1e3 * result.residual_m, result.residual_rad * kDegreesARadian) +
         DescribeExpected(result.expected, IsSeenFromAFoot(project, result.planned.motion),
                          elastic);
}

int Compensate(const CompensateOptions& options) {
  const CalibratedRobot robot = OpenCalibratedRobot(options.calibration, options.project);
  OutputSet outputs;
  std::vector<std::filesystem::path> inputs = robot.inputs;
  inputs.emplace_back(options.motion);
  outputs.Protect(inputs);
  outputs.Protect(RecordedFiles(robot));
  outputs.Declare(options.output,
                  [&](const std::string& text) { return IsMotionTable(robot.project.tree, text); });
  DeclareJson(options.common.json_file, outputs);
  outputs.Prepare();

  const JointMotion planned = ReadMotion(options.motion, robot.project);
  const RuntimeContent content =
      options.as == "urdf" ? RuntimeContent::kGeometry : RuntimeContent::kEverything;
  const RuntimeModel model = MakeRuntimeModel(robot.project, robot.calibration, content);
  CompensatedMotion result = CompensateMotion(
      robot.project, model, planned,
      {.loads = options.loads == "planned" ? MotionLoads::kPlanned : MotionLoads::kStatics,
       .most_left_m = 1e-3 * options.most_left_mm,
       .most_turned_rad = options.most_turned_deg * M_PI / 180.0,
       .ease_s = options.ease_s,
       .limits = options.limits.Of()});
  result.expected = ExpectErrors(robot, result.planned.motion);
  const bool fine = result.broken.empty();
  if (fine) outputs.Set(options.output, FormatMotionTable(robot.project.tree, result.planned));
  outputs.Set(options.common.json_file, MakeCompensationJson(result));
  outputs.Publish();

  const bool quiet = options.common.Silent();
  const bool elastic = options.as == "compensated";
  Print(quiet, DescribeCompensation(result, robot.project, elastic));
  WarnOfExtra(robot, elastic);
  for (const std::string& reason : result.warnings) spdlog::warn("{}", reason);
  for (const std::string& reason : result.broken) spdlog::error("{}", reason);
  if (!fine) {
    spdlog::error("the corrected motion must not be played: nothing was written");
    return kNotConverged;
  }
  Print(quiet, fmt::format("Written: {}\n", options.output));
  return kFine;
}

}  // namespace

void AddCompensate(CLI::App& app, Action& action) {
  auto options = std::make_shared<CompensateOptions>();
  CLI::App* command = app.add_subcommand(
      "compensate",
      "Correct a planned motion so that hands, feet and waist go where the plan meant");
  AddCalibratedRobot(*command, options->calibration, options->project);
  command->add_option("--motion", options->motion, "Planned joint trajectory (CSV with time)")
      ->required()
      ->type_name("FILE");
  command->add_option("-o,--output", options->output, "The corrected trajectory (CSV)")
      ->required()
      ->check(IsNamed)
      ->type_name("FILE");
  command
      ->add_option("--as", options->as,
                   "What the correction knows: compensated (geometry and elasticity) or urdf "
                   "(geometry alone, as the calibrated URDF)")
      ->transform(OneOf({"compensated", "urdf"}))
      ->capture_default_str();
  command
      ->add_option("--loads", options->loads,
                   "What deflects the robot: statics (the weight in each posture) or planned "
                   "(torques of the motion, for fast ones)")
      ->transform(OneOf({"statics", "planned"}))
      ->capture_default_str();
  command
      ->add_option("--most-left-mm", options->most_left_mm,
                   "Refuse a motion where more is left at the end of a limb that does not yield; a "
                   "degree counts " +
                       Degree() + ", of an arm with too few joints " + DegreeOfFew())
      ->check(InBounds("compensate --most-left-mm"))
      ->capture_default_str();
  command
      ->add_option(
          "--most-turned-deg", options->most_turned_deg,
          "Refuse a motion where a hand is turned by more from its planned attitude, of an "
          "arm with too few joints for place and attitude")
      ->check(InBounds("compensate --most-turned-deg"))
      ->capture_default_str();
  command
      ->add_option("--ease-s", options->ease_s,
                   "Time in which a correction comes to its largest speed, and brakes: near "
                   "stretched limbs the best one starts within a sample. More is left meanwhile "
                   "(try 0.03); 0: none")
      ->check(InBounds("compensate --ease-s"))
      ->capture_default_str();
  AddCorrectionLimits(*command, options->limits);
  AddOutputOptions(*command, options->common);
  command->footer(
      "Ends with 4, and writes nothing, where the corrected motion would break a limit, or leaves "
      "too much.\n"
      "Example: elastocal compensate out --motion motion.csv -o corrected.csv");
  command->callback([&action, options] { action = [options] { return Compensate(*options); }; });
}

}  // namespace elastocal::cli
