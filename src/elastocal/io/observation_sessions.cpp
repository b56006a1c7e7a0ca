// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/observation_sessions.hpp"

#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/measurement/encoder_starts.hpp"
#include "elastocal/robot/coordinates.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr double kMostCounts = 1e15;  // counts beyond are no whole numbers

/// "6 starts of the robot, by gripper (a step of 4.4e-05)"
std::string DescribeStarts(const EncoderStarts& starts, const std::vector<std::string>& names) {
  std::string text = fmt::format("{} starts of the robot, by ", starts.count());
  for (std::size_t i = 0; i < starts.columns.size(); ++i) {
    text += fmt::format("{}{} (an encoder with steps of {:.3g})", i == 0 ? "" : " and ",
                        names[static_cast<std::size_t>(starts.columns[i])], starts.steps[i]);
  }
  return text;
}

}  // namespace

void SessionReader::Take() {
  ++rows_;
  for (int column : columns_.ignored) {
    ignored_.push_back(
        ParseNumber(table_.Cell(column)).value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  const SessionRule& rule = project_.contact->sessions;
  std::string key;
  for (int column : columns_.sessions) {
    if (!key.empty()) key += "/";
    if (rule.quantum <= 0.0) {
      if (IsGap(table_.Cell(column))) {
        table_.FailCell(column,
                        "there is no session (contact.sessions.column); the name of one "
                        "was expected in every row");
      }
      key += std::string(table_.Cell(column));
      continue;
    }
    const double steps = std::round(table_.Number(column) / rule.quantum);
    if (!(std::abs(steps) < kMostCounts)) {
      table_.FailCell(column, "this is no number of steps of contact.sessions.counts.quantum");
    }
    const std::int64_t count = static_cast<std::int64_t>(steps) % rule.modulo;
    key += std::to_string(count < 0 ? count + rule.modulo : count);
  }
  keys_.push_back(std::move(key));
}

std::vector<std::string> SessionReader::Sessions(const Eigen::MatrixXd& q,
                                                 std::vector<std::string>& warnings) const {
  if (columns_.sessions.empty()) return ByEncoders(q, warnings);
  if (project_.contact->sessions.quantum <= 0.0) WarnOfLoneSessions(warnings);
  return keys_;
}

void SessionReader::WarnOfLoneSessions(std::vector<std::string>& warnings) const {
  std::map<std::string, int> rows;
  for (const std::string& key : keys_) ++rows[key];
  std::vector<std::string> others;
  for (const auto& [key, count] : rows) {
    if (count > 1) others.push_back(key);
  }
  for (const auto& [key, count] : rows) {
    const std::string near = count == 1 ? DidYouMean(key.substr(0, 60), others) : "";
    if (near.empty()) continue;
    warnings.push_back(table_.source() + ": one row alone is of session " + Quote(key) +
                       " (contact.sessions.column)" + near);
  }
}

std::vector<std::string> SessionReader::ByEncoders(const Eigen::MatrixXd& q,
                                                   std::vector<std::string>& warnings) const {
  std::vector<std::string> sessions(static_cast<std::size_t>(rows_), table_.source());
  const std::optional<bool>& rule = project_.contact->sessions.from_encoders;
  if (rule && !*rule) return sessions;
  Eigen::MatrixXd readings(q.rows(), q.cols() + static_cast<Eigen::Index>(columns_.ignored.size()));
  readings.leftCols(q.cols()) = q;
  std::vector<std::string> names;
  for (int c = 0; c < static_cast<int>(q.cols()); ++c) {
    names.push_back(JointOfCoordinate(project_.tree, c).name);
  }
  if (!columns_.ignored.empty()) {
    readings.rightCols(readings.cols() - q.cols()) = StackRows(ignored_, sessions.size());
    for (int column : columns_.ignored) names.push_back(table_.header()[column]);
  }
  const EncoderStarts starts = FindEncoderStarts(readings);
  if (starts.count() == 0) {
    if (rule) {
      warnings.push_back(table_.source() +
                         ": no encoder tells starts of the robot apart (contact.sessions: "
                         "{from_encoders: true}); the file is one session");
    }
    return sessions;
  }
  const std::string what = table_.source() + ": " + DescribeStarts(starts, names);
  if (!rule) {
    warnings.push_back(
        what +
        "; the file is one session all the same: tell them apart by contact.sessions: "
        "{from_encoders: true}, or say {from_encoders: false}");
    return sessions;
  }
  warnings.push_back(what + "; each is a session of its own");
  for (std::size_t row = 0; row < sessions.size(); ++row) {
    sessions[row] += fmt::format(", start {}", starts.start[row] + 1);
  }
  return sessions;
}

}  // namespace elastocal
