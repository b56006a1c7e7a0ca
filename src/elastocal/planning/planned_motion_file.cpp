// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/planned_motion_file.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include "elastocal/files/yaml_word.hpp"
#include "elastocal/tables/table_reader.hpp"
#include "elastocal/tables/table_writer.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

using Buffer = fmt::memory_buffer;

std::vector<std::string> JointNames(const RobotTree& tree) {
  std::vector<std::string> names;
  for (const int k : tree.coordinate_joint) {
    names.push_back(tree.joints[static_cast<std::size_t>(k)].name);
  }
  return names;
}

/// Header with which all motion tables of the robot begin.
std::string MotionColumns(const RobotTree& tree) {
  std::string columns = "time";
  for (const std::string& joint : JointNames(tree)) columns += "," + MakeCell(joint);
  return columns;
}

/// Whether a line consists of a time and `positions` positions, in the digits of FormatMotionTable.
bool HasOwnDigits(std::string line, std::size_t positions) {
  std::vector<std::string_view> cells;
  if (!SplitCells(line, ',', Quotes::kEnclose, cells) || cells.size() <= positions) return false;
  for (std::size_t i = 0; i <= positions; ++i) {
    const std::optional<double> number = ParseNumber(cells[i]);
    if (!number) return false;
    if (cells[i] != fmt::format("{:.12g}", *number)) return false;
  }
  return true;
}

/// Support as text, "left_sole_link+right_sole_link", which SupportNames reads.
std::string SupportCell(const RobotTree& tree, const std::vector<int>& links) {
  std::string cell;
  for (const int link : links) {
    cell += (cell.empty() ? "" : "+") + tree.links[static_cast<std::size_t>(link)].name;
  }
  return cell.empty() ? "none" : MakeCell(cell);
}

template <typename Row>
void AppendList(Buffer& out, const Row& values, const char* format) {
  fmt::format_to(std::back_inserter(out), "[");
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (i > 0) fmt::format_to(std::back_inserter(out), ", ");
    fmt::format_to(std::back_inserter(out), fmt::runtime(format), values[i]);
  }
  fmt::format_to(std::back_inserter(out), "]");
}

}  // namespace

std::string FormatMotionTable(const RobotTree& tree, const PlannedMotion& planned) {
  const std::vector<std::string> joints = JointNames(tree);
  Buffer out;
  const auto put = std::back_inserter(out);
  fmt::format_to(put, "{}", MotionColumns(tree));
  const JointMotion& motion = planned.motion;
  if (!motion.support.empty()) fmt::format_to(put, ",support");
  const bool has_forces = planned.zmp.rows() > 0;
  if (has_forces) {
    fmt::format_to(put, ",zmp_x,zmp_y");
    for (const std::string& joint : joints) {
      fmt::format_to(put, ",{}", MakeCell("torque_" + joint));
    }
  }
  fmt::format_to(put, "\n");
  for (Eigen::Index i = 0; i < motion.q.rows(); ++i) {
    fmt::format_to(put, "{:.12g}", motion.time_s[i]);
    for (const double position : motion.q.row(i)) fmt::format_to(put, ",{:.12g}", position);
    if (!motion.support.empty()) {
      fmt::format_to(put, ",{}", SupportCell(tree, motion.support[static_cast<std::size_t>(i)]));
    }
    if (has_forces) {
      fmt::format_to(put, ",{:.6f},{:.6f}", planned.zmp(i, 0), planned.zmp(i, 1));
      for (const double torque : planned.torques.row(i)) fmt::format_to(put, ",{:.4f}", torque);
    }
    fmt::format_to(put, "\n");
  }
  return fmt::to_string(out);
}

bool IsMotionTable(const RobotTree& tree, const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  const std::string columns = MotionColumns(tree);
  std::getline(lines, line);
  if (!line.starts_with(columns)) return false;
  const std::string_view more = std::string_view(line).substr(columns.size());
  if (!more.empty() && !more.starts_with(",support") && !more.starts_with(",zmp_x")) return false;
  const std::size_t positions = tree.coordinate_joint.size();
  while (std::getline(lines, line)) {
    if (!HasOwnDigits(line, positions)) return false;
  }
  return true;
}

std::vector<int> CommandedCoordinates(const RobotTree& tree, const std::vector<Chain>& chains,
                                      const JointMotion& motion) {
  std::vector<bool> commanded(static_cast<std::size_t>(tree.coordinate_count()), false);
  for (const Chain& chain : chains) {
    const Link& tip = tree.links[static_cast<std::size_t>(chain.tip_link)];
    for (const int k : JointsToBody(tree, tip.body)) {
      const Joint& joint = tree.joints[static_cast<std::size_t>(k)];
      if (!joint.mimic) commanded[static_cast<std::size_t>(joint.coordinate)] = true;
    }
  }
  std::vector<int> coordinates;
  for (int c = 0; c < tree.coordinate_count(); ++c) {
    const auto q = motion.q.col(c);
    if (commanded[static_cast<std::size_t>(c)] || q.maxCoeff() > q.minCoeff()) {
      coordinates.push_back(c);
    }
  }
  return coordinates;
}

std::string FormatJointTrajectory(const RobotTree& tree, const std::vector<int>& coordinates,
                                  const JointMotion& motion, int every, RosVersion ros) {
  const auto stamp = [&](long long nanoseconds) {
    const long long seconds = nanoseconds / 1000000000, rest = nanoseconds % 1000000000;
    return ros == RosVersion::kRos1 ? fmt::format("{{secs: {}, nsecs: {}}}", seconds, rest)
                                    : fmt::format("{{sec: {}, nanosec: {}}}", seconds, rest);
  };
  Buffer out;
  const auto put = std::back_inserter(out);
  fmt::format_to(put, "header:\n  stamp: {}\n  frame_id: ''\njoint_names:\n", stamp(0));
  const std::vector<std::string> names = JointNames(tree);
  for (const int c : coordinates) {
    fmt::format_to(put, "  - {}\n", YamlWord(names[static_cast<std::size_t>(c)]));
  }
  fmt::format_to(put, "points:\n");
  const Eigen::Index last = motion.q.rows() - 1;
  for (Eigen::Index i = 0; i <= last; i = i == last ? last + 1 : std::min(i + every, last)) {
    const Eigen::Index before = std::max<Eigen::Index>(i - 1, 0);
    const Eigen::Index after = std::min(i + 1, last);
    const double span = motion.time_s[after] - motion.time_s[before];
    const Eigen::RowVectorXd speed = (motion.q.row(after) - motion.q.row(before)) / span;
    const Eigen::RowVectorXd position = motion.q.row(i);
    fmt::format_to(put, "  - positions: ");
    AppendList(out, Eigen::RowVectorXd(position(coordinates)), "{:.9g}");
    fmt::format_to(put, "\n    velocities: ");
    AppendList(out, Eigen::RowVectorXd(speed(coordinates)), "{:.6g}");
    const double after_start = motion.time_s[i] - motion.time_s[0];
    fmt::format_to(put, "\n    time_from_start: {}\n", stamp(std::llround(after_start * 1e9)));
  }
  return fmt::to_string(out);
}

}  // namespace elastocal
