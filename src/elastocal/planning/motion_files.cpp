// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include <nlohmann/json.hpp>

#include "elastocal/math/input_error.hpp"
#include "elastocal/planning/plan_motion.hpp"
#include "elastocal/planning/project_motion.hpp"
#include "elastocal/tables/json_text.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

using Json = nlohmann::ordered_json;

/// Whether a text begins with a header that FormatMotionTable writes for `plan`.
bool HasPlannedHeader(const std::string& text) {
  const std::string header = text.substr(0, text.find('\n'));
  return header.starts_with("time,") && header.find(",support,zmp_x,zmp_y") != std::string::npos;
}

/// Whether a file begins with such a header.
bool IsPlannedMotion(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  std::ifstream stream(file);
  std::string header;
  std::getline(stream, header);
  return HasPlannedHeader(header);
}

/// Of each chain the part in which its feet stand, as a motion of its own.
std::vector<PlannedMotion> ChainMotions(const MotionPlan& plan) {
  const PlannedMotion& whole = plan.whole;
  std::vector<PlannedMotion> motions;
  Eigen::Index row = whole.motion.q.rows();
  for (const PlannedTour& tour : plan.planned) row -= tour.motion.q.rows();
  for (const PlannedTour& tour : plan.planned) {
    const Eigen::Index first = row + tour.begin, count = tour.end - tour.begin;
    const auto support = whole.motion.support.begin() + first;
    PlannedMotion part;
    part.motion.time_s =
        whole.motion.time_s.segment(first, count).array() - whole.motion.time_s[first];
    part.motion.q = whole.motion.q.middleRows(first, count);
    part.motion.support.assign(support, support + count);
    part.zmp = whole.zmp.middleRows(first, count);
    part.torques = whole.torques.middleRows(first, count);
    motions.push_back(std::move(part));
    row += tour.motion.q.rows();
  }
  return motions;
}

Json TourJson(const Project& project, const PlannedTour& set, double begin_s, double rate_hz) {
  Json json = {{"name", set.name},
               {"duration_s", static_cast<double>(set.motion.q.rows()) / rate_hz},
               {"visits", Json::array()},
               {"rests_s", Json::array()},
               {"left_out", Json::array()}};
  const auto time_s = [&](int row) { return std::round(1e3 * (begin_s + row / rate_hz)) / 1e3; };
  for (const Visit& visit : set.visits) {
    json["visits"].push_back(visit.posture);
    json["rests_s"].push_back({time_s(visit.begin), time_s(visit.end)});
  }
  for (const LeftOut& left : set.left_out) {
    json["left_out"].push_back({{"posture", left.posture}, {"reason", ReasonText(project, left)}});
  }
  return json;
}

}  // namespace

MotionFiles::MotionFiles(const fs::path& output)
    : motion(output), margins(output.parent_path() / (output.stem().string() + "_margins.json")) {}

void MotionFiles::AddChains(const fs::path& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const fs::path file = folder / (name + "_motion.csv");
    std::error_code error;
    if (fs::exists(file, error) && !IsPlannedMotion(file)) {
      throw InputError(file.string() +
                       ": is there and is no planned motion; it is not replaced. Choose another "
                       "folder for the motions of the chains");
    }
    chains.push_back(file);
  }
}

void MotionFiles::Declare(const RobotTree& tree, OutputSet& outputs) const {
  const auto is_own = [&](const std::string& text) {
    return HasPlannedHeader(text) || IsMotionTable(tree, text);
  };
  outputs.Declare(motion, is_own);
  outputs.Declare(margins, "{");
  outputs.Declare(trajectory, "header:");
  for (const fs::path& file : chains) outputs.Declare(file, is_own);
}

void SetMotionFiles(const MotionFiles& files, const Project& project, const MotionPlan& plan,
                    const std::vector<MotionTrial>& trials, OutputSet& outputs) {
  constexpr int kTrajectoryStep = 5;  // samples of a trajectory: 20 Hz
  outputs.Set(files.motion, FormatMotionTable(project.tree, plan.whole));
  outputs.Set(files.margins, FormatMotionSummary(project, plan, trials));
  if (!files.trajectory.empty()) {
    const JointMotion& motion = plan.whole.motion;
    outputs.Set(files.trajectory,
                FormatJointTrajectory(project.tree,
                                      CommandedCoordinates(project.tree, project.chains, motion),
                                      motion, kTrajectoryStep, files.ros));
  }
  if (files.chains.empty()) return;
  const std::vector<PlannedMotion> motions = ChainMotions(plan);
  for (std::size_t i = 0; i < motions.size(); ++i) {
    outputs.Set(files.chains.at(i), FormatMotionTable(project.tree, motions[i]));
  }
}

std::string FormatMotionSummary(const Project& project, const MotionPlan& plan,
                                const std::vector<MotionTrial>& trials) {
  const MotionMargins& margins = plan.margins;
  Json json;
  json["planning_s"] = plan.seconds;
  json["sets"] = Json::array();
  Eigen::Index row = plan.whole.motion.q.rows();
  for (const PlannedTour& set : plan.planned) row -= set.motion.q.rows();
  for (const PlannedTour& set : plan.planned) {
    const double begin = static_cast<double>(row) / plan.rate_hz;
    json["sets"].push_back(TourJson(project, set, begin, plan.rate_hz));
    row += set.motion.q.rows();
  }
  json["margins"] = {
      {"clearance_m", margins.clearance.value}, {"zmp_m", margins.zmp.value},
      {"torque_share", margins.torque.value},   {"velocity_share", margins.velocity.value},
      {"friction", margins.friction.value},     {"foot_moved_m", margins.foot_moved.value}};
  for (const auto& [seed, run] : trials) {
    json["tries"].push_back({{"seed", seed},
                             {"stood", run.stood},
                             {"time_s", run.time_s},
                             {"largest_lean", run.largest_lean},
                             {"tracking", run.tracking},
                             {"least_zmp_margin", run.least_zmp_margin},
                             {"largest_shift", run.largest_shift}});
  }
  return JsonText(json);
}

}  // namespace elastocal
