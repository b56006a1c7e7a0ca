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
  (*this)[ParameterKind::kTorsion] = 5e-5;
  (*this)[ParameterKind::kBending] = 5e-5;
  (*this)[ParameterKind::kLegForce] = 1e-5;
  (*this)[ParameterKind::kLegMoment] = 5e-5;
  (*this)[ParameterKind::kTorqueBias] = 2.0;
}

Prior Prior::Scaled(const PriorScale& scale) const {
  Prior scaled = *this;
  for (int kind = 0; kind < kParameterKindCount; ++kind) {
    if (IsElastic(static_cast<ParameterKind>(kind))) continue;
    const bool angle = IsAngle(static_cast<ParameterKind>(kind));
    scaled.sd[kind] *= angle ? scale.angles : scale.lengths;
  }
  return scaled;
}

}  // namespace elastocal
