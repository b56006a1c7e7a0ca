// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/io/observation_columns.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/tables/table_reader.hpp"

namespace elastocal {

/// What tells the sessions of a table of observations, taken row by row.
class SessionReader {
 public:
  /// Keeps references.
  SessionReader(const Table& table, const ObservationColumns& columns, const Project& project)
      : table_(table), columns_(columns), project_(project) {}

  /// Takes the row read last. Throws InputError for what is no number of steps of
  /// contact.sessions.counts.quantum, and for a row without the name of its session.
  void Take();

  /// The session of each row, by a name that no other file has where the project does not say
  /// otherwise: the file, or the start of the robot in it that the encoders tell. `q`: positions of
  /// all rows. Adds to `warnings` what the encoders tell; where the project does not ask them, as a
  /// proposal.
  std::vector<std::string> Sessions(const Eigen::MatrixXd& q,
                                    std::vector<std::string>& warnings) const;

 private:
  /// Names of sessions that one row alone has, and that are near to others: mistyped.
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
