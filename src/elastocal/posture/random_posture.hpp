// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "elastocal/math/random.hpp"
#include "elastocal/posture/feasible_set.hpp"

namespace elastocal {

/// Number of draws that random postures took.
struct SamplingCount {
  long tries = 0;             ///< draws
  long feasible_at_once = 0;  ///< draws that were feasible without repair
  long found = 0;             ///< draws that were feasible, repaired or not
  double Yield() const { return tries > 0 ? static_cast<double>(found) / tries : 0.0; }
};

/// Draws random feasible postures (paper section 3.5.2). It draws a random pose of the chain's end
/// in its workspace, which the joints reach as well as they can (bounded least squares from a
/// random start). If another constraint is then broken, the first joints (shoulder or hip) move
/// until it holds, or another pose is drawn. For a chain without workspace, joint positions are
/// drawn within their limits.
class FeasibleSampler {
 public:
  /// Keeps a reference.
  FeasibleSampler(FeasibleSet& set, std::uint64_t seed) : set_(set), random_(seed) {}

  /// Returns nothing if `most_tries` end poses gave no feasible posture: the workspace is empty, or
  /// nearly so.
  std::optional<Eigen::VectorXd> Draw(int most_tries = 2000);

  const SamplingCount& count() const { return count_; }
  /// After a failed draw: the limit that most of the tries broke.
  std::string Blame() const;

 private:
  Eigen::VectorXd DrawStart();
  void PlaceEnd(const Eigen::Vector3d& p, const Eigen::Matrix3d& R, Eigen::VectorXd& x);
  void Repair(Eigen::VectorXd& x);

  FeasibleSet& set_;
  Random random_;
  SamplingCount count_;
  std::map<std::string, int> blame_;
};

}  // namespace elastocal
