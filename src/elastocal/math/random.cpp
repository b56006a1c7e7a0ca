// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/random.hpp"

#include <cmath>

namespace elastocal {

double Random::Uniform(double lower, double upper) {
  const double unit = static_cast<double>(engine_() >> 11) * 0x1.0p-53;
  return lower + (upper - lower) * unit;
}

double Random::Normal(double sd) {
  // Box-Muller; 1 - u is in (0, 1], where the logarithm is finite.
  const double radius = std::sqrt(-2.0 * std::log(1.0 - Uniform(0.0, 1.0)));
  return sd * radius * std::cos(2.0 * M_PI * Uniform(0.0, 1.0));
}

Eigen::VectorXd Random::NormalVector(Eigen::Index size, double sd) {
  Eigen::VectorXd values(size);
  for (double& value : values) value = Normal(sd);
  return values;
}

int Random::Index(int count) { return static_cast<int>(Uniform(0.0, 1.0) * count); }

}  // namespace elastocal
