// SPDX-License-Identifier: Apache-2.0
#include "motions.hpp"

#include <sstream>

#include "elastocal/files/output_set.hpp"
#include "elastocal/io/motion_file.hpp"
#include "elastocal/planning/leave_room.hpp"
#include "postures.hpp"

namespace elastocal::python {
namespace {

Names LinkNames(const RobotTree& tree, const std::vector<int>& links) {
  Names names;
  for (int link : links) names.push_back(tree.links[link].name);
  return names;
}

JointMotion MotionFromDict(const py::dict& given, const Project& project) {
  JointMotion motion;
  for (const auto& [key, value] : given) {
    const auto name = key.cast<std::string>();
    if (name == "time_s") {
      motion.time_s = value.cast<Eigen::VectorXd>();
    } else if (name == "positions") {
      motion.q = value.cast<Eigen::MatrixXd>();
    } else if (name == "support") {
      for (const Names& links : value.cast<std::vector<Names>>()) {
        motion.support.emplace_back();
        for (const std::string& link : links) {
          motion.support.back().push_back(FindLink(project.tree, link));
        }
      }
    } else {
      throw InputError("motion: '" + name + "'; 'time_s', 'positions' and 'support' were expected");
    }
  }
  const Eigen::Index samples = motion.time_s.size();
  if (motion.q.rows() != samples || motion.q.cols() != project.tree.coordinate_count()) {
    throw InputError("motion: positions of (" + std::to_string(motion.q.rows()) + ", " +
                     std::to_string(motion.q.cols()) + "); (" + std::to_string(samples) + ", " +
                     std::to_string(project.tree.coordinate_count()) +
                     ") were expected, one row a time and one column a joint");
  }
  const auto supports = static_cast<Eigen::Index>(motion.support.size());
  if (supports != 0 && supports != samples) {
    throw InputError("motion: support of " + std::to_string(supports) + " samples; " +
                     std::to_string(samples) + " were expected");
  }
  return motion;
}

MotionPlanOptions PlanOptionsOf(double move_s, double rest_s, std::optional<double> zmp_margin_mm,
                                std::optional<double> lift_mm, std::optional<double> inset_mm,
                                std::optional<double> approach_mm,
                                std::optional<double> torque_share, double velocity_share,
                                bool balanced, int threads) {
  ExpectBounded("plan --move-s", move_s);
  ExpectBounded("plan --rest-s", rest_s);
  if (torque_share) ExpectBounded("plan --torque-share", *torque_share);
  ExpectBounded("plan --velocity-share", velocity_share);
  ExpectWithin("threads", threads, 1, 64);
  MotionPlanOptions options;
  options.plan.path.duration_s = move_s;
  options.plan.hold_s = rest_s;
  options.plan.balanced = balanced;
  options.torque_share = torque_share;
  options.limits.velocity_share = velocity_share;
  options.threads = threads;
  const auto set = [](const char* option, const std::optional<double>& given, double& metres) {
    if (!given) return;
    ExpectBounded(option, *given);
    metres = 1e-3 * *given;
  };
  set("plan --zmp-margin-mm", zmp_margin_mm, options.limits.zmp_margin);
  set("plan --lift-mm", lift_mm, options.plan.lift_m);
  set("plan --inset-mm", inset_mm, options.plan.inset);
  set("plan --approach-mm", approach_mm, options.approach.height);
  return options;
}

/// Throws Infeasible for a motion that the program would not write.
void ExpectPlayable(const MotionPlan& plan, bool balanced) {
  std::string why;
  for (const std::string& chain : plan.impossible) {
    why += "chain '" + chain + "' has no posture that can be kept and reached; ";
  }
  if (why.empty() && balanced) {
    for (const LimitUse& use : plan.broken()) why += "breaks a limit: " + use.Describe() + "; ";
  }
  if (!why.empty()) throw Infeasible("no motion: " + why.substr(0, why.size() - 2));
}

PyPlan PlanFor(const ProjectOrFile& project_or_file, const py::object& postures,
               const std::optional<std::string>& kind, int count, double move_s, double rest_s,
               std::optional<double> zmp_margin_mm, std::optional<double> lift_mm,
               std::optional<double> inset_mm, std::optional<double> approach_mm,
               std::optional<double> torque_share, double velocity_share, bool balanced, int robots,
               double floor_friction, double leg_geometry_scale, bool stabilised, int threads,
               std::uint64_t seed, const Progress& progress) {
  const Project& project = project_or_file.project;
  if (postures.is_none() != kind.has_value()) {
    throw InputError("postures or kind: one of them was expected");
  }
  ExpectWithin("count", count, 1, 1000);
  ExpectWithin("robots", robots, 0, 1000);
  ExpectBounded("plan --floor-friction", floor_friction);
  ExpectBounded("plan --leg-geometry-scale", leg_geometry_scale);
  MotionPlanOptions options =
      PlanOptionsOf(move_s, rest_s, zmp_margin_mm, lift_mm, inset_mm, approach_mm, torque_share,
                    velocity_share, balanced, threads);
  options.validation.random_postures = count;
  const MotionTrialOptions tries{.robots = robots,
                                 .seed = seed,
                                 .leg_errors = leg_geometry_scale,
                                 .floor_friction = floor_friction,
                                 .stabilised = stabilised,
                                 .threads = threads};
  std::vector<ChainPostures> given;
  ValidationKind of = ValidationKind::kSine;
  if (kind) {
    of = Named<ValidationKind>("kind", *kind,
                               {{"sine", ValidationKind::kSine},
                                {"random", ValidationKind::kRandom},
                                {"repeatability", ValidationKind::kRepeatability}});
  } else {
    given = PosturesOf(postures, project);
  }
  CheckTries(project, tries);
  return Unlocked([&] {
    const Project narrow = WithRoom(project, std::nullopt);
    PyPlan planned{project,
                   kind ? PlanValidationMotion(narrow, of, seed, options, progress)
                        : PlanMotion(narrow, given, options, progress),
                   {}};
    CountToOwnLimits(project, narrow, options, planned.plan);
    ExpectPlayable(planned.plan, balanced);
    planned.trials = TryMotion(project, planned.plan.whole.motion, tries);
    return planned;
  });
}

void SavePlan(const PyPlan& planned, const Path& file, const Path& trajectory,
              const Path& per_chain) {
  MotionFiles files(file);
  files.trajectory = trajectory;
  if (!per_chain.empty()) {
    Names chains;
    for (const PlannedTour& tour : planned.plan.planned) chains.push_back(tour.name);
    files.AddChains(per_chain, chains);
  }
  OutputSet outputs;
  outputs.Protect({planned.project.file, planned.project.urdf});
  files.Declare(planned.project.tree, outputs);
  outputs.Prepare();
  SetMotionFiles(files, planned.project, planned.plan, planned.trials, outputs);
  outputs.Publish();
}

std::vector<Names> SupportOf(const PyPlan& planned) {
  std::vector<Names> support;
  for (const std::vector<int>& links : planned.plan.whole.motion.support) {
    support.push_back(LinkNames(planned.project.tree, links));
  }
  return support;
}

void AddPlanClass(py::module_& module) {
  py::class_<PyPlan>(module, "Plan", "A motion of the whole robot that plan() found.")
      .def_property_readonly(
          "time_s", [](const PyPlan& p) { return p.plan.whole.motion.time_s; }, "(samples,), s.")
      .def_property_readonly(
          "positions", [](const PyPlan& p) { return p.plan.whole.motion.q; },
          "(samples, joints), rad or m, by Project.joints.")
      .def_property_readonly(
          "torques", [](const PyPlan& p) { return p.plan.whole.torques; },
          "Expected of the motors, (samples, joints), N.m or N.")
      .def_property_readonly(
          "zmp", [](const PyPlan& p) { return p.plan.whole.zmp; },
          "Zero-moment point on the floor, (samples, 2), m.")
      .def_property_readonly("support", SupportOf, "By sample, the links that stand on the floor.")
      .def_property_readonly(
          "left_out", [](const PyPlan& p) { return p.plan.left_out; },
          "What of the postures is left out, and why, a sentence each.")
      .def_property_readonly(
          "broken",
          [](const PyPlan& p) {
            Names broken;
            for (const LimitUse& use : p.plan.broken()) broken.push_back(use.Describe());
            return broken;
          },
          "Limits that the motion breaks; of a balanced one, none.")
      .def_property_readonly(
          "summary",
          [](const PyPlan& p) {
            return FromJson(FormatMotionSummary(p.project, p.plan, p.trials));
          },
          "The dict of `elastocal plan --json`: visits, margins, and how the robots that tried it "
          "came through.")
      .def("save", SavePlan, "file"_a, py::kw_only(), "trajectory"_a = "", "per_chain"_a = "",
           "Writes the motion (CSV) and its margins beside it. trajectory: a file, also as a ROS "
           "trajectory_msgs/JointTrajectory (YAML). per_chain: a folder, also a motion for each "
           "chain.",
           py::call_guard<LongCall>());
}

}  // namespace

JointMotion MotionOf(const py::object& given, const Project& project) {
  PlannedMotion motion;
  if (py::isinstance<PyPlan>(given)) {
    motion = given.cast<const PyPlan&>().plan.whole;
  } else if (py::isinstance<py::dict>(given)) {
    motion.motion = MotionFromDict(given.cast<py::dict>(), project);
  } else {
    return ReadMotion(given.cast<Path>(), project);
  }
  std::istringstream text(FormatMotionTable(project.tree, motion));
  return ReadMotion(text, "motion", project);
}

void AddMotions(py::module_& module) {
  AddPlanClass(module);
  const MotionPlanOptions plan;
  const MotionTrialOptions tries;
  module.def(
      "plan", PlanFor, "project"_a, "postures"_a = py::none(), py::kw_only(),
      "kind"_a = std::nullopt, "count"_a = plan.validation.random_postures,
      "move_s"_a = plan.plan.path.duration_s, "rest_s"_a = plan.plan.hold_s,
      "zmp_margin_mm"_a = std::nullopt, "lift_mm"_a = std::nullopt, "inset_mm"_a = std::nullopt,
      "approach_mm"_a = std::nullopt, "torque_share"_a = std::nullopt,
      "velocity_share"_a = plan.limits.velocity_share, "balanced"_a = true, "robots"_a = 0,
      "floor_friction"_a = tries.floor_friction, "leg_geometry_scale"_a = tries.leg_errors,
      "stabilised"_a = true, "threads"_a = plan.threads, "seed"_a = 1, "progress"_a = Progress(),
      "Plans a motion through calibration postures that the robot does standing by itself, like "
      "the command of that name. postures: a Design, a posture file, or a dict of chains with "
      "arrays (postures, joints), rad or m, or lists of dicts of joints. kind: a validation motion "
      "instead, 'sine', 'random' (`count` postures a chain) or 'repeatability'. robots: so many "
      "with errors try it. Arguments are those of the command, in the unit of their suffix, else "
      "SI. Raises InfeasibleError where there is no motion or it breaks a limit.");
}

}  // namespace elastocal::python
