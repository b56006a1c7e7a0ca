// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include <Eigen/Core>

#include "elastocal/math/random.hpp"

namespace elastocal {

/// Robots of one series have errors in common: of the same jig, of the same wrong length in CAD.
struct SeriesOptions {
  int seed = 1;        ///< of what the series has in common
  double share = 0.0;  ///< of the variance of each error that it has in common, 0 to 1
};

/// Random numbers for one kind of error of one robot of a series: distributed like those of Random,
/// and over the robots of a series correlated by the share. With the share 0 they are those of
/// Random(StreamSeed(robot_seed, purpose)).
class SeriesRandom {
 public:
  SeriesRandom(std::uint64_t robot_seed, const SeriesOptions& series, std::string_view purpose);

  /// Normal with mean 0 and standard deviation `sd`: a weighted sum of both draws.
  double Normal(double sd);
  Eigen::VectorXd NormalVector(Eigen::Index size, double sd);
  /// Uniform in [lower, upper]: the probability of such a sum.
  double Uniform(double lower, double upper);
  /// What a robot does not share, with whatever share.
  Random& own() { return own_; }

 private:
  Random own_, common_;
  double share_;
};

}  // namespace elastocal
