// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/io/observation_columns.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/tables/table_reader.hpp"

namespace elastocal {

/// Finds the session of each row of a table of observations.
class SessionReader {
 public:
  /// Keeps references.
  SessionReader(const Table& table, const ObservationColumns& columns, const Project& project)
      : table_(table), columns_(columns), project_(project) {}

  /// Takes the row read last. Throws InputError for a cell that is no number of steps of
  /// contact.sessions.counts.quantum, and for a row without the name of its session.
  void Take();

  /// Name of the session of each row. If the project has columns for sessions, these name it.
  /// Otherwise it is the file, or if the project says so (SessionRule::from_encoders), the start of
  /// the robot in the file that the encoders tell; no other file has this name. `q` has the
  /// positions of all rows. Adds to `warnings` what the encoders tell; if the project does not say
  /// whether to use them, this is a proposal.
  std::vector<std::string> Sessions(const Eigen::MatrixXd& q,
                                    std::vector<std::string>& warnings) const;

 private:
  /// Warns of names of sessions that only one row has and that are similar to others: they may be
  /// mistyped.
  void WarnOfLoneSessions(std::vector<std::string>& warnings) const;
  std::vector<std::string> ByEncoders(const Eigen::MatrixXd& q,
                                      std::vector<std::string>& warnings) const;

  const Table& table_;
  const ObservationColumns& columns_;
  const Project& project_;
  std::vector<std::string> keys_;  // by row, where columns tell sessions
  std::vector<double> ignored_;    // row by row, of the columns that are not read otherwise
  int rows_ = 0;
};

}  // namespace elastocal
