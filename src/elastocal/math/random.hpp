// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>

#include <Eigen/Core>

namespace elastocal {

/// Seeded random numbers. The standard fixes std::mt19937_64 but not the distributions, so these
/// are written out: the same seed gives the same numbers with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// Uniform in [lower, upper).
  double Uniform(double lower, double upper);
  /// Normal with mean 0 and standard deviation `sd`.
  double Normal(double sd);
  /// `size` independent normal numbers.
  Eigen::VectorXd NormalVector(Eigen::Index size, double sd);
  /// Uniform integer in [0, count).
  int Index(int count);

 private:
  std::mt19937_64 engine_;
};

}  // namespace elastocal
