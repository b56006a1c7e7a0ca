#include "elastocal/calibration/options.hpp"

#include <cmath>

namespace elastocal {

Prior::Prior() {
  sd.fill(std::numeric_limits<double>::infinity());
  const double angle = 0.5 * M_PI / 180.0;
  const double length = 1e-3;
  for (ParameterKind kind : {ParameterKind::kTheta, ParameterKind::kAlpha, ParameterKind::kBeta,
                             ParameterKind::kGamma}) {
    (*this)[kind] = angle;
  }
  for (ParameterKind kind : {ParameterKind::kR, ParameterKind::kD, ParameterKind::kB}) {
    (*this)[kind] = length;
  }
}

Prior Prior::Scaled(double factor) const {
  Prior scaled = *this;
  for (double& value : scaled.sd) value *= factor;
  return scaled;
}

}  // namespace elastocal
