// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/left_at_limbs.hpp"

#include <cmath>

#include <fmt/format.h>

#include "elastocal/runtime/core_equations.h"

namespace elastocal {

void KeepLarger(double value, double time_s, const std::string& where, MotionExtreme& extreme) {
  if (value > extreme.value) extreme = {value, time_s, where};
}

std::vector<LeftAtLimb> NothingLeft(const RuntimeModel& model) {
  std::vector<LeftAtLimb> left;
  for (std::size_t t = 0; t < model.tips.size(); ++t) {
    left.push_back({.limb = model.tip_names[t],
                    .most = {},
                    .most_turned = {},
                    .yields = model.tips[t].yields != 0,
                    .arm_m = model.tips[t].arm,
                    .place_first = model.tips[t].arm < EC_ARM});
  }
  return left;
}

void LookAtLimbs(const Compensator& compensator, double time_s, std::vector<LeftAtLimb>& left) {
  for (std::size_t t = 0; t < left.size(); ++t) {
    const double now = compensator.tip_left_m(static_cast<int>(t));
    KeepLarger(now, time_s, left[t].limb, left[t].most);
    KeepLarger(compensator.tip_left_rad(static_cast<int>(t)), time_s, left[t].limb,
               left[t].most_turned);
    if (now > kLeftOver_m) ++left[t].samples;
  }
}

std::vector<std::string> Exceeded(const LeftAtLimb& one, double most_left_m,
                                  double most_turned_rad) {
  constexpr double kDegreesARadian = 180.0 / M_PI;
  std::vector<std::string> sentences;
  if (one.most.value > most_left_m) {
    sentences.push_back(fmt::format(
        "{:.2f} mm are left at the end of {} at {:.2f} s, more than {:.2f} mm (a degree counts "
        "{:.1f} mm)",
        1e3 * one.most.value, one.limb, one.most.time_s, 1e3 * most_left_m,
        DegreeAsMillimetres(one.arm_m)));
  }
  if (one.place_first && one.most_turned.value > most_turned_rad) {
    sentences.push_back(
        fmt::format("{:.2f} deg are left at the end of {} at {:.2f} s, more than {:.2f} deg",
                    kDegreesARadian * one.most_turned.value, one.limb, one.most_turned.time_s,
                    kDegreesARadian * most_turned_rad));
  }
  return sentences;
}

}  // namespace elastocal
