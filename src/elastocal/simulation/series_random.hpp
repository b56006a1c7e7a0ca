// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include <Eigen/Core>

#include "elastocal/math/random.hpp"

namespace elastocal {

/// Errors that the robots of one series have in common (from the same jig, or the same wrong length
/// in CAD).
struct SeriesOptions {
  int seed = 1;        ///< seed of the errors that the series has in common
  double share = 0.0;  ///< share of each error's variance that is in common, 0 to 1
};

/// Random numbers for one kind of error of one robot of a series. They are distributed like those
/// of Random, and their correlation between two robots of the series is the share. With share 0
/// they are those of Random(StreamSeed(robot_seed, purpose)).
class SeriesRandom {
 public:
  SeriesRandom(std::uint64_t robot_seed, const SeriesOptions& series, std::string_view purpose);

  /// Normal with mean 0 and standard deviation `sd`: a weighted sum of the robot's own draw and the
  /// series' common draw.
  double Normal(double sd);
  Eigen::VectorXd NormalVector(Eigen::Index size, double sd);
  /// Uniform in [lower, upper]: the normal distribution function of such a sum, scaled.
  double Uniform(double lower, double upper);
  /// Random numbers of the robot alone, for what a series never has in common.
  Random& own() { return own_; }

 private:
  Random own_, common_;
  double share_;
};

}  // namespace elastocal
