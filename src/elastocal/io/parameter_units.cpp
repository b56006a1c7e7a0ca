// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/parameter_units.hpp"

#include <cmath>

namespace elastocal {

NamedUnits UnitsOf(const std::string& parameter) {
  const std::string suffix = parameter.substr(parameter.rfind('.') + 1);
  for (const char* angle : {"theta", "alpha", "beta", "gamma", "zero", "tilt_x", "tilt_y"}) {
    if (suffix == angle) return {{"rad"}, M_PI};
  }
  if (suffix == "torque_bias") return {{"N.m", "N"}};
  if (suffix == "gear") return {{"1"}, 1.0};
  if (suffix.starts_with("coupling_")) return {{"1", "m/rad", "rad/m"}, M_PI};
  if (suffix.starts_with("suspension_r")) return {{"rad/(N.m)"}};
  if (suffix.starts_with("suspension_")) return {{"1/N"}};
  if (suffix.starts_with("drift_") || suffix.starts_with("creep_")) return {{"m/h"}};
  if (suffix == "mass") return {{"kg"}};
  if (suffix.starts_with("moment_")) return {{"kg.m"}};
  for (const char* correction : {"eccentricity_sin", "eccentricity_cos", "ellipticity_sin",
                                 "ellipticity_cos", "backlash", "hysteresis", "stiffening"}) {
    if (suffix == correction) return {{"rad", "m"}, M_PI};
  }
  if (suffix.starts_with("compliance_")) return {{"rad/(N.m)", "m/N"}};
  return {{"m"}, 1000.0};  // markers and waist in the frame of any laboratory
}

}  // namespace elastocal
