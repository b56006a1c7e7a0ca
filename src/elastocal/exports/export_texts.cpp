// SPDX-License-Identifier: Apache-2.0
#include "elastocal/exports/export_texts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "elastocal/description/series_springs.hpp"
#include "elastocal/files/xml_edit.hpp"
#include "elastocal/files/yaml_word.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

constexpr int kHipJoints = 3;
constexpr double kAlong = 0.9;  // cosine between the axis of a hip's joint and z, x or y
/// Axes of a hip's joints; flex-joints uses the last two in reverse order.
constexpr std::array<int, kHipJoints> kHipAxes = {2, 0, 1};
constexpr std::array<int, 2> kFlexAxes = {1, 0};

/// A sum of compliances about one axis, rad/(N.m).
struct SummedCompliance {
  bool estimated = false;
  double value = 0.0, half_width = 0.0;  ///< half width of its 95 % interval

  double Stiffness() const { return 1.0 / value; }
};

/// The two legs, the left one (y to the left of the root link) first.
std::array<const Leg*, 2> LeftAndRight(const std::vector<Leg>& legs,
                                       const std::vector<Transform>& T_root_link) {
  if (legs.size() != 2) {
    throw InputError(fmt::format("format flex_joints: {} legs; two were expected", legs.size()));
  }
  const auto left = [&](const Leg& leg) {
    return T_root_link[static_cast<std::size_t>(leg.foot_link)].translation().y();
  };
  const bool first = left(legs[0]) > left(legs[1]);
  return {&legs[first ? 0 : 1], &legs[first ? 1 : 0]};
}

void CheckHip(const RobotTree& tree, const Leg& leg, const std::vector<Transform>& T_root_link) {
  for (std::size_t i = 0; i < kHipAxes.size(); ++i) {
    if (i < leg.joints.size()) {
      const Joint& joint = tree.joints[static_cast<std::size_t>(leg.joints[i])];
      const Eigen::Vector3d axis =
          T_root_link[static_cast<std::size_t>(joint.child_link)].linear() * joint.axis;
      if (joint.type == JointType::kRevolute && std::abs(axis[kHipAxes[i]]) > kAlong) continue;
    }
    throw InputError("format flex_joints: " + leg.chain +
                     ": a hip of three joints about z, x and y, from the root link outwards, was "
                     "expected");
  }
}

/// By parameter name: square of the cosine between the spring's axis and an axis of the root link.
std::map<std::string, double> HipWeights(const std::vector<SeriesSpring>& springs, const Leg& leg,
                                         const RobotTree& tree, int axis,
                                         const std::vector<Transform>& T_root_link) {
  std::map<std::string, double> weights;
  for (const SeriesSpring& spring : springs) {
    const auto hip = leg.joints.begin() + kHipJoints;
    if (std::find(leg.joints.begin(), hip, spring.joint) == hip) continue;
    if (spring.place == SpringPlace::kLeg) continue;
    Eigen::Vector3d about = spring.axis;
    if (spring.place == SpringPlace::kJoint) {
      const Joint& joint = tree.joints[static_cast<std::size_t>(spring.joint)];
      about = T_root_link[static_cast<std::size_t>(joint.child_link)].linear() * about;
    }
    weights[spring.name] = about[axis] * about[axis];
  }
  return weights;
}

/// Weighted sum of estimates, with its interval by the covariance as far as it is known.
SummedCompliance Sum(const CalibrationEstimate& estimate,
                     const std::map<std::string, double>& weights) {
  SummedCompliance sum;
  Eigen::VectorXd row = Eigen::VectorXd::Zero(estimate.covariance.rows());
  double alone = 0.0;  // variance of the estimates that are not in the covariance
  for (const ParameterEstimate& parameter : estimate.parameters) {
    const auto weight = weights.find(parameter.name);
    if (weight == weights.end()) continue;
    sum.estimated = true;
    sum.value += weight->second * parameter.value;
    const auto at = std::ranges::find(estimate.covariance_names, parameter.name);
    if (at != estimate.covariance_names.end()) {
      row[at - estimate.covariance_names.begin()] = weight->second;
    } else if (std::isfinite(parameter.sd)) {
      alone += std::pow(weight->second * parameter.sd, 2);
    }
  }
  double variance = alone;
  if (row.size() > 0) variance += row.dot(estimate.covariance * row);
  sum.half_width = estimate.interval_factor * std::sqrt(variance);
  return sum;
}

std::string Number(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : std::string(".inf");
}

std::string Interval(const SummedCompliance& sum) {
  const double most = sum.value - sum.half_width > 0.0 ? 1.0 / (sum.value - sum.half_width)
                                                       : std::numeric_limits<double>::infinity();
  return fmt::format("{:.4g} to {}", 1.0 / (sum.value + sum.half_width),
                     std::isfinite(most) ? fmt::format("{:.4g}", most) : "rigid");
}

}  // namespace

std::string YamlComment(const std::vector<std::string>& lines) {
  std::string text;
  for (std::string line : lines) {
    std::ranges::replace(line, '\n', ' ');  // a line end in a file name would end the comment
    text += "# " + line + "\n";
  }
  return text;
}

std::string XmlComment(const std::vector<std::string>& lines) {
  std::string text = fmt::format("{}", fmt::join(lines, "\n     "));
  for (std::size_t at = text.find("--"); at != std::string::npos; at = text.find("--", at)) {
    text.replace(at, 2, "- -");  // "--" would end the comment
  }
  return "<!-- " + text + " -->\n";
}

std::string MakePalYaml(const CalibratedUrdf& urdf, const std::vector<std::string>& heading) {
  std::string text = YamlComment(heading) +
                     "# Metres and radians, to be added to the origin of the joint, and the zero "
                     "of its encoder:\n# position in the URDF = position of the encoder + offset\n";
  std::map<std::string, double> zeros = urdf.encoder_offsets;
  for (const auto& [joint, origin] : urdf.calibrated) zeros.emplace(joint, 0.0);
  for (const auto& [joint, zero] : zeros) {
    const auto calibrated = urdf.calibrated.find(joint);
    UrdfOrigin change{};
    if (calibrated != urdf.calibrated.end()) {
      const UrdfOrigin& nominal = urdf.nominal.at(joint);
      change.xyz = calibrated->second.xyz - nominal.xyz;
      change.rpy = calibrated->second.rpy - nominal.rpy;
    } else {
      change.xyz.setZero();
      change.rpy.setZero();
    }
    text += fmt::format(
        "{}: {{x: {:.17g}, y: {:.17g}, z: {:.17g}, roll: {:.17g}, pitch: {:.17g}, yaw: {:.17g}, "
        "offset: {:.17g}}}\n",
        YamlWord(joint), change.xyz.x(), change.xyz.y(), change.xyz.z(), change.rpy.x(),
        change.rpy.y(), change.rpy.z(), zero);
  }
  return text;
}

std::string MakeRos2Transmissions(const CalibratedUrdf& urdf,
                                  const std::vector<std::string>& heading) {
  std::string text = XmlComment(heading) +
                     "<!-- Position of the joint = position of the actuator / reduction + offset "
                     "(rad or m). Belongs to the\n     URDF of export format urdf_encoder. -->\n";
  for (const auto& [joint, zero] : urdf.encoder_offsets) {
    text += fmt::format(
        "<transmission name=\"{0}_transmission\">\n"
        "  <plugin>transmission_interface/SimpleTransmission</plugin>\n"
        "  <joint name=\"{0}\" role=\"joint1\">\n    <offset>{1:.17g}</offset>\n  </joint>\n"
        "</transmission>\n",
        EscapedXml(joint), zero);
  }
  return text;
}

std::string MakeFlexJointsYaml(const CalibrationResult& result, const RobotTree& calibrated,
                               const std::vector<Leg>& legs, const CalibrationEstimate& estimate,
                               std::optional<double> damping,
                               const std::vector<std::string>& heading) {
  const std::vector<Transform> T_root_link =
      LinkTransforms(calibrated, Eigen::VectorXd::Zero(calibrated.coordinate_count()));
  // Springs with unit compliance for all compliances of the calibration, which give their axes.
  CalibrationResult unit = result;
  for (int i = 0; i < unit.model.parameter_count(); ++i) {
    if (IsCompliance(unit.model.parameters[static_cast<std::size_t>(i)].kind)) unit.delta[i] = 1.0;
  }
  const std::vector<SeriesSpring> springs = SeriesSprings(unit, calibrated, legs);
  std::string text =
      YamlComment(heading) +
      YamlComment(
          {"For flex-joints (Gepetto): springs between the waist and the legs, about y and "
           "x of the root",
           "link, N.m/rad. Sums of the root link's and the hip joints' compliances in the "
           "zero posture,",
           "with 95 % intervals. Compliances of the legs as a whole are not among them. The "
           "URDF that",
           "belongs to them: export --format urdf --beside-springs."});
  const std::array<const char*, 2> sides = {"left", "right"};
  const std::array<const Leg*, 2> by_side = LeftAndRight(legs, T_root_link);
  for (std::size_t side = 0; side < sides.size(); ++side) {
    CheckHip(calibrated, *by_side[side], T_root_link);
    std::array<SummedCompliance, 2> sums;
    for (std::size_t i = 0; i < sums.size(); ++i) {
      sums[i] =
          Sum(estimate, HipWeights(springs, *by_side[side], calibrated, kFlexAxes[i], T_root_link));
    }
    if (!sums[0].estimated) {
      throw InputError("format flex_joints: " + estimate.source +
                       " has no compliance of the hip of " + by_side[side]->chain);
    }
    std::string joints;
    for (int k = 0; k < kHipJoints; ++k) {
      const int joint = by_side[side]->joints[static_cast<std::size_t>(k)];
      joints += (k > 0 ? ", " : "") + calibrated.joints[static_cast<std::size_t>(joint)].name;
    }
    text += fmt::format("# {} hip ({}): {} about y, {} about x\n{}_stiffness: [{}, {}]\n",
                        sides[side], joints, Interval(sums[0]), Interval(sums[1]), sides[side],
                        Number(sums[0].Stiffness()), Number(sums[1].Stiffness()));
  }
  if (!damping) {
    return text + YamlComment({"left_damping and right_damping: postures at rest tell no damping. "
                               "Set your own, or by export --hip-damping."});
  }
  text += YamlComment({"Not identified: the value of --hip-damping, N.m.s/rad"});
  for (const char* side : sides) {
    text += fmt::format("{}_damping: [{}, {}]\n", side, Number(*damping), Number(*damping));
  }
  return text;
}

}  // namespace elastocal
