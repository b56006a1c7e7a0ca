// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/observation_fault.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "elastocal/math/numbers.hpp"
#include "elastocal/observation/seen_tag.hpp"

namespace elastocal {
namespace {

constexpr int kFewestFrozen = 5;  // postures
constexpr double kPerDegree = M_PI / 180.0;

}  // namespace

double DriftedShare(int posture, int count) {
  return static_cast<double>(posture) / static_cast<double>(std::max(1, count - 1));
}

void AddEffect(const ObservedRobot& model, int quantity, int posture, Observations& observations) {
  const auto effect = static_cast<int>(observations.effects.size());
  observations.effects.push_back({quantity, "moved"});
  for (Observation& observation : observations.all) {
    const std::vector<int>& on = model.instrument(observation.instrument).quantities;
    if (observation.posture < posture || std::find(on.begin(), on.end(), quantity) == on.end()) {
      continue;
    }
    observation.effects.push_back(effect);
  }
}

int LengthsMeasured(const Instrument& instrument) {
  const std::string_view kind = instrument.kind();
  if (kind == "pose" || kind == "position") return 3;
  return kind == "wire" || kind == "plane distance" ? 1 : 0;
}

int TagSeenBy(const Instrument& instrument) {
  return std::string_view(instrument.kind()) == "image" ? instrument.quantities[1] : -1;
}

Observations WithTagsLarger(const ObservedRobot& model, const Observations& observations, int tag,
                            double factor) {
  Observations larger = observations;
  for (Observation& observation : larger.all) {
    const int seen = TagSeenBy(model.instrument(observation.instrument));
    if (seen < 0 || (tag >= 0 && seen != tag)) continue;
    observation.measured = CornersOfLargerTag(observation.measured, factor);
  }
  return larger;
}

std::optional<ObservationFault> FindFrozen(const Observations& observations, int coordinate) {
  const auto positions = observations.q.col(coordinate);
  const int count = observations.posture_count();
  ObservationFault longest;
  longest.kind = ObservationFaultKind::kJointFrozen;
  longest.coordinate = coordinate;
  for (int begin = 0, i = 1; i <= count; ++i) {
    if (i < count && positions[i] == positions[begin]) continue;
    if (i - begin > longest.count) {
      longest.posture = begin;
      longest.count = i - begin;
    }
    begin = i;
  }
  if (longest.count < kFewestFrozen || 2 * longest.count > count) return std::nullopt;
  return longest;
}

Observations WithoutFault(const ObservationFault& fault, const ObservedRobot& model,
                          const Observations& observations) {
  if (fault.kind == ObservationFaultKind::kJointFrozen) {
    std::vector<int> others;
    for (int i = 0; i < observations.posture_count(); ++i) {
      if (i < fault.posture || i >= fault.posture + fault.count) others.push_back(i);
    }
    return SelectPostures(observations, others);
  }
  if (fault.kind == ObservationFaultKind::kTagSize) {
    return WithTagsLarger(model, observations, fault.quantity, 1.0 + fault.size);
  }
  Observations without = observations;
  if (fault.kind == ObservationFaultKind::kMoved) {
    AddEffect(model, fault.quantity, fault.posture, without);
    return without;
  }
  const auto here = [&](int posture) {
    return fault.file < 0 || observations.postures[Size(posture)].file == fault.file;
  };
  if (fault.kind == ObservationFaultKind::kScale) {
    for (Observation& observation : without.all) {
      if (!here(observation.posture)) continue;
      observation.measured.head(LengthsMeasured(model.instrument(observation.instrument))) /=
          1.0 + fault.size;
    }
    return without;
  }
  const int count = observations.posture_count();
  for (int i = fault.posture; i < count; ++i) {
    if (!here(i)) continue;
    double& position = without.q(i, fault.coordinate);
    if (fault.kind == ObservationFaultKind::kJointGain) {
      position /= 1.0 + fault.size;
    } else if (fault.kind == ObservationFaultKind::kJointDrift) {
      position -= fault.size * DriftedShare(i, count);
    } else {
      position -= fault.size;
    }
  }
  return without;
}

std::string DescribeFault(const ObservationFault& fault, const ObservedRobot& model,
                          const Observations& observations) {
  const PosturePlace& place = observations.postures[Size(fault.posture)];
  const std::string from = observations.files[Size(place.file)] + ":" + std::to_string(place.line);
  const std::string in = fault.file < 0 ? "" : " in " + observations.files[Size(fault.file)];
  char number[120];
  if (fault.kind == ObservationFaultKind::kScale) {
    std::snprintf(number, sizeof number, " are %.4f +- %.4f times the true ones", 1.0 + fault.size,
                  fault.sd);
    return "lengths as they were measured" + in + number;
  }
  const auto quantity_name = [&] {
    const std::string& name = model.setup.quantities[Size(fault.quantity)].name;
    return name.substr(0, name.find('.'));
  };
  if (fault.kind == ObservationFaultKind::kTagSize) {
    const bool all = fault.quantity < 0;
    std::snprintf(number, sizeof number, " is %.4f +- %.4f times the true one", 1.0 + fault.size,
                  fault.sd);
    return "size_mm of " + (all ? "all tags" : quantity_name()) + number;
  }
  if (fault.kind == ObservationFaultKind::kMoved) {
    const Quantity& quantity = model.setup.quantities[Size(fault.quantity)];
    const double unit = fault.turns ? kPerDegree : 1e-3;
    std::snprintf(number, sizeof number, " was moved%s by some %.2g %s before ",
                  quantity.of_surroundings ? "" : " on its link", std::abs(fault.size) / unit,
                  fault.turns ? "deg" : "mm");
    return quantity_name() + number + from;
  }
  const RobotTree& tree = model.robot.tree;
  const Joint& joint = tree.joints[Size(tree.coordinate_joint[Size(fault.coordinate)])];
  if (fault.kind == ObservationFaultKind::kJointGain) {
    std::snprintf(number, sizeof number, ": its positions are %.4f +- %.4f times the true ones",
                  1.0 + fault.size, fault.sd);
    return joint.name + number + in;
  }
  if (fault.kind == ObservationFaultKind::kJointFrozen) {
    return joint.name + ": its positions are frozen in " + std::to_string(fault.count) +
           " postures from " + from + " on, while it moved";
  }
  const bool slides = joint.type == JointType::kPrismatic;
  const double unit = slides ? 1e-3 : kPerDegree;
  if (fault.kind == ObservationFaultKind::kJointDrift) {
    std::snprintf(number, sizeof number,
                  ": its positions drift by %.3f +- %.3f %s from the first row to the last",
                  fault.size / unit, fault.sd / unit, slides ? "mm" : "deg");
    return joint.name + number;
  }
  std::snprintf(number, sizeof number, ": its positions are off by %.3f +- %.3f %s from ",
                fault.size / unit, fault.sd / unit, slides ? "mm" : "deg");
  return joint.name + number + from + " on";
}

}  // namespace elastocal
