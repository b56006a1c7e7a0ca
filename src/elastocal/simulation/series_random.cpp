// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/series_random.hpp"

#include <cmath>
#include <string>

#include "elastocal/simulation/stream_seed.hpp"

namespace elastocal {

SeriesRandom::SeriesRandom(std::uint64_t robot_seed, const SeriesOptions& series,
                           std::string_view purpose)
    : own_(StreamSeed(robot_seed, purpose)),
      common_(
          StreamSeed(static_cast<std::uint64_t>(series.seed), "series " + std::string(purpose))),
      share_(series.share) {}

double SeriesRandom::Normal(double sd) {
  if (share_ == 0.0) return own_.Normal(sd);
  const double own = own_.Normal(sd), common = common_.Normal(sd);
  return std::sqrt(share_) * common + std::sqrt(1.0 - share_) * own;
}

Eigen::VectorXd SeriesRandom::NormalVector(Eigen::Index size, double sd) {
  Eigen::VectorXd values(size);
  for (double& value : values) value = Normal(sd);
  return values;
}

double SeriesRandom::Uniform(double lower, double upper) {
  if (share_ == 0.0) return own_.Uniform(lower, upper);
  return lower + (upper - lower) * 0.5 * std::erfc(-Normal(1.0) * std::sqrt(0.5));
}

}  // namespace elastocal
