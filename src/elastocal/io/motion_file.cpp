// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/motion_file.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "elastocal/io/posture_checks.hpp"
#include "elastocal/io/recording_columns.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/robot/legs.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

/// Half an hour at 100 Hz; this bounds the memory that a file can take.
constexpr double kLongestMotion = 3600.0;  // s
constexpr int kMostSamples = 200000;
constexpr double kSpeedMargin = 1.05;  // margin of speeds, because samples are rounded

/// Which column of a motion or a list of postures holds what; -1 where there is none.
struct MotionColumns {
  int time = -1, support = -1;
  std::vector<int> coordinates;  ///< by coordinate of the tree
};

/// Finds the columns. `timed`: the table is a motion, whose time is read and which has no markers.
MotionColumns FindMotionColumns(const Table& table, const Project& project, bool timed) {
  constexpr int kTime = 0, kSupport = 1, kCoordinates = 2;
  if (timed && table.header().front().starts_with("robot:")) {
    table.Fail(
        "this is a posture file (YAML), which 'simulate' plays with --postures and of which 'plan' "
        "makes a motion; a trajectory was expected, a table with a column 'time'");
  }
  const RobotTree& tree = project.tree;
  ColumnRoles roles;
  for (const Joint& joint : tree.joints) {
    const int role = joint.mimic ? kPassedOver : kCoordinates + joint.coordinate;
    roles[joint.name] = role;
    roles[JointColumn(project, joint.name)] = role;
  }
  roles.emplace("support", kSupport);
  for (const std::string& name : {std::string("time"), project.recording.time}) {
    roles.emplace(name, timed ? kTime : kPassedOver);
  }
  for (const char* name : {"zmp_x", "zmp_y"}) roles.emplace(name, kPassedOver);
  for (const Joint& joint : tree.joints) roles.emplace("torque_" + joint.name, kPassedOver);
  for (const Marker& marker : project.markers) {
    if (timed) break;
    for (const std::string& column : MarkerColumns(project, marker.name)) {
      roles.emplace(column, kPassedOver);
    }
  }
  const auto count = kCoordinates + static_cast<std::size_t>(tree.coordinate_count());
  const std::vector<int> found = FindRecordingColumns(table, std::move(roles), count, project);
  const MotionColumns columns{
      found[kTime], found[kSupport], {found.begin() + kCoordinates, found.end()}};
  if (timed && columns.time < 0) table.Fail("there is no column 'time'");
  if (std::all_of(columns.coordinates.begin(), columns.coordinates.end(),
                  [](int column) { return column < 0; })) {
    table.Fail("there is no column of any joint of robot " + Quote(tree.name));
  }
  return columns;
}

using LinksByName = std::map<std::string, std::vector<int>, std::less<>>;

/// Values of the column `support`: the tip of a chain, `none`, and `both` (feet of a robot with two
/// legs).
LinksByName FindSupports(const Project& project) {
  LinksByName supports;
  std::vector<NamedChain> chains;
  for (const Chain& chain : project.chains) {
    chains.push_back({chain.name, chain.from_link, chain.tip_link});
    supports[project.tree.links[chain.tip_link].name] = {chain.tip_link};
  }
  std::vector<Leg> legs = FindLegs(project.tree, chains);
  if (!project.soles.empty()) {  // of a robot that stands, an arm that hangs down is no leg
    std::erase_if(legs, [&](const Leg& leg) {
      return std::ranges::count(project.soles, leg.foot_link, &Sole::link) == 0;
    });
  }
  if (legs.size() == 2) supports["both"] = {legs[0].foot_link, legs[1].foot_link};
  supports["none"] = {};
  return supports;
}

/// The links that a cell of the column `support` names: one of these or several joined by '+'.
std::vector<int> ReadSupport(const Table& table, int column, const LinksByName& supports) {
  const std::string_view cell = table.Cell(column);
  std::vector<int> links;
  for (std::size_t begin = 0; begin <= cell.size();) {
    const std::size_t end = std::min(cell.find('+', begin), cell.size());
    const std::string_view name = Trim(cell.substr(begin, end - begin));
    const auto found = supports.find(name);
    if (found == supports.end()) {
      std::vector<std::string> known;
      for (const auto& [text, named] : supports) known.push_back(text);
      table.FailCell(column, "found " + Quote(name) +
                                 "; expected 'both', 'none' or the tip of a chain" +
                                 DidYouMean(std::string(name.substr(0, 60)), known));
    }
    for (int link : found->second) {
      if (std::find(links.begin(), links.end(), link) != links.end()) {
        table.FailCell(column, Quote(cell) + " names a link twice");
      }
      links.push_back(link);
    }
    begin = end + 1;
  }
  return links;
}

/// Throws InputError for degrees, and for positions and speeds beyond the joint's limits.
void CheckJoint(const JointMotion& motion, int coordinate, const Joint& joint,
                const std::string& column) {
  const auto place = [&](Eigen::Index row) { return Place(motion.source, motion.line[row]); };
  CheckUnits(joint, motion.q.col(coordinate), place);
  const auto fail = [&](Eigen::Index row, const std::string& what) {
    throw InputError(place(row) + "column " + Quote(column) + ": " + what);
  };
  for (Eigen::Index row = 0; row < motion.q.rows(); ++row) {
    const double q = motion.q(row, coordinate);
    if (BeyondLimits(joint, q)) {
      fail(row, "found " + FormatNumber(q) + "; the joint's limits are " +
                    FormatNumber(joint.limits.lower) + " and " + FormatNumber(joint.limits.upper));
    }
    if (motion.time_s.size() == 0 || row == 0) continue;
    const double speed =
        std::abs(q - motion.q(row - 1, coordinate)) / (motion.time_s[row] - motion.time_s[row - 1]);
    if (speed > kSpeedMargin * joint.limits.velocity) {
      fail(row, "moves by " + FormatNumber(speed) +
                    (joint.type == JointType::kRevolute ? " rad/s" : " m/s") +
                    "; the joint's limit is " + FormatNumber(joint.limits.velocity));
    }
  }
}

JointMotion ReadSamples(std::istream& stream, const std::string& source, const Project& project,
                        bool timed) {
  Table table(stream, source);
  const MotionColumns columns = FindMotionColumns(table, project, timed);
  const LinksByName supports = FindSupports(project);
  JointMotion motion;
  motion.source = source;
  std::vector<double> time, q;
  while (table.Next()) {
    if (table.row_count() > kMostSamples) {
      table.Fail("more than " + std::to_string(kMostSamples) + " rows");
    }
    motion.line.push_back(table.line());
    if (timed) {
      AppendTime(table, columns.time, time);
      if (time.back() - time.front() > kLongestMotion) {
        table.FailCell(columns.time, FormatNumber(time.back() - time.front()) +
                                         " s after the first row; a motion lasts at most " +
                                         FormatNumber(kLongestMotion) + " s");
      }
    }
    for (int column : columns.coordinates) {
      q.push_back(column < 0 ? kNaN : table.Number(column));
    }
    if (columns.support >= 0) {
      motion.support.push_back(ReadSupport(table, columns.support, supports));
    }
  }
  const std::size_t rows = motion.line.size(), least_rows = timed ? 2 : 1;
  if (rows < least_rows) {
    throw InputError(source + ": found " + std::to_string(rows) +
                     " rows below the header; expected " + std::to_string(least_rows) + " or more");
  }
  motion.q = StackRows(q, rows);
  if (timed) motion.time_s = StackRows(time, rows);
  for (int c = 0; c < project.tree.coordinate_count(); ++c) {
    const int column = columns.coordinates[c];
    if (column < 0) continue;
    CheckJoint(motion, c, project.tree.joints[project.tree.coordinate_joint[c]],
               table.header()[column]);
  }
  return motion;
}

}  // namespace

JointMotion ReadMotion(std::istream& stream, const std::string& source, const Project& project) {
  return ReadSamples(stream, source, project, true);
}

JointMotion ReadMotion(const std::filesystem::path& file, const Project& project) {
  std::istringstream stream = OpenTable(file);
  return ReadMotion(stream, file.string(), project);
}

JointMotion ReadPostureList(std::istream& stream, const std::string& source,
                            const Project& project) {
  return ReadSamples(stream, source, project, false);
}

JointMotion ReadPostureList(const std::filesystem::path& file, const Project& project) {
  std::istringstream stream = OpenTable(file);
  return ReadPostureList(stream, file.string(), project);
}

}  // namespace elastocal
