#include "elastocal/io/calibrated_urdf.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <tinyxml2.h>

#include "elastocal/io/text.hpp"
#include "elastocal/io/urdf_reader.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/robot/special_geometry.hpp"

namespace elastocal {
namespace {

constexpr double kGateTolerance = 1e-9;  // m and rad
constexpr int kGatePostures = 1000;

bool IsZeroOffset(const RobotTree& tree, const Parameter& parameter) {
  return parameter.joint >= 0 &&
         parameter.kind == (tree.joints[parameter.joint].type == JointType::kRevolute
                                ? ParameterKind::kTheta
                                : ParameterKind::kR);
}

/// The calibrated origin of a joint: parent link to child link at position 0. The rotation about
/// the joint's axis commutes with theta and r of eq. 1, so what is left of it is constant.
Transform CalibratedOrigin(const ErrorModel& model, const Geometry& geometry, int k) {
  const Joint& joint = model.tree.joints[k];
  const Geometry::JointConstants& constants = geometry.joints[k];
  Transform T_parent_twisted = Transform::Identity();
  T_parent_twisted.linear() = constants.R_parent_twisted;
  T_parent_twisted.translation() = constants.p_parent_twisted;
  Transform T_parent_link = model.tree.links[joint.parent_link].T_body_link;
  if (joint.parent_body > 0) {
    T_parent_link = model.placements[joint.parent_body - 1].T_joint_body * T_parent_link;
  }
  return T_parent_link.inverse() * T_parent_twisted * RotZ(constants.theta) * TrZ(constants.r) *
         model.placements[k].T_joint_body;
}

/// Largest difference between the written URDF and the calibrated model, waist to bodies.
double LargestDifference(const CalibrationResult& calibration, const RobotTree& written,
                         const std::map<std::string, double>& encoder_offsets) {
  const ErrorModel& model = calibration.model;
  const Geometry geometry = ApplyErrors(model, calibration.delta);
  RobotTree with_offsets = written;
  for (Joint& joint : with_offsets.joints) {
    const auto offset = encoder_offsets.find(joint.name);
    if (offset != encoder_offsets.end()) joint.offset += offset->second;
  }
  Random random(1);
  double largest = 0.0;
  for (int i = 0; i < kGatePostures; ++i) {
    const Eigen::VectorXd q = RandomPosture(model.tree, random);
    const std::vector<Transform> T_ref_body = BodyTransforms(model, geometry, q);
    const std::vector<Transform> T_root_link = LinkTransforms(with_offsets, q);
    for (int k : model.active_joints) {
      const Transform T = (T_ref_body[0].inverse() * T_ref_body[k + 1]).inverse() *
                          T_root_link[written.joints[k].child_link];
      largest = std::max({largest, T.translation().norm(), RotationAngle(T.linear())});
    }
  }
  return largest;
}

std::vector<std::string> BrokenGeometry(const RobotTree& nominal, const RobotTree& calibrated) {
  constexpr double kBroken = 1e-6;
  std::vector<std::string> warnings;
  for (const SpecialGeometry& group : FindSpecialGeometry(nominal)) {
    const double deviation = Deviation(calibrated, group);
    if (deviation <= kBroken) continue;
    std::string names;
    for (int joint : group.joints) {
      names += (names.empty() ? "" : ", ") + nominal.joints[joint].name;
    }
    warnings.push_back(
        group.kind == SpecialGeometry::Kind::kSphericalWrist
            ? fmt::format("the axes of {} no longer meet in a point ({:.3f} mm apart): inverse "
                          "kinematics in closed form for a spherical wrist is off by as much",
                          names, 1e3 * deviation)
            : fmt::format("the axes of {} are no longer parallel ({:.3f} deg): inverse kinematics "
                          "in closed form that relies on it is off by as much",
                          names, deviation * 180.0 / M_PI));
  }
  return warnings;
}

/// A correction of a joint that carries branches without markers beside one with markers moves these
/// as well, though nothing was measured there.
std::vector<std::string> UnrecordedBranches(const ErrorModel& model,
                                            const std::vector<bool>& changed) {
  const std::vector<int>& active = model.active_joints;
  std::vector<std::string> warnings;
  for (int k : active) {
    std::string unrecorded;
    bool branches = false;
    for (int i = 0; i < static_cast<int>(model.tree.joints.size()); ++i) {
      if (model.tree.joints[i].parent_body != k + 1) continue;
      if (std::binary_search(active.begin(), active.end(), i)) {
        branches = true;
      } else {
        unrecorded += (unrecorded.empty() ? "" : ", ") + model.tree.joints[i].name;
      }
    }
    if (!changed[k] || !branches || unrecorded.empty()) continue;
    warnings.push_back(
        fmt::format("the correction of {} also moves what {} carries, of which this recording shows "
                    "nothing: it may belong to the recorded branch alone",
                    model.tree.joints[k].name, unrecorded));
  }
  return warnings;
}

}  // namespace

CalibratedUrdf MakeCalibratedUrdf(const std::string& urdf, const std::string& source,
                                  const CalibrationResult& calibration, ZeroOffsets zero_offsets) {
  const ErrorModel& model = calibration.model;
  const std::map<std::string, UrdfOrigin> origins = ReadOrigins(urdf, source);
  CalibratedUrdf result;
  Eigen::VectorXd in_origins = calibration.delta;
  std::vector<bool> changed(model.tree.joints.size(), false);
  for (int i = 0; i < model.parameter_count(); ++i) {
    const Parameter& parameter = model.parameters[i];
    if (parameter.joint < 0 || calibration.delta[i] == 0.0) continue;
    if (zero_offsets == ZeroOffsets::kEncoder && IsZeroOffset(model.tree, parameter)) {
      result.encoder_offsets[model.tree.joints[parameter.joint].name] = calibration.delta[i];
      in_origins[i] = 0.0;
    } else {
      changed[parameter.joint] = true;
    }
  }

  const Geometry geometry = ApplyErrors(model, in_origins);
  for (int k : model.active_joints) {
    if (!changed[k]) continue;
    const std::string& name = model.tree.joints[k].name;
    const UrdfOrigin& nominal = origins.at(name);
    const Transform T = CalibratedOrigin(model, geometry, k);
    result.nominal[name] = nominal;
    result.calibrated[name] = {T.translation(), ToRpy(T.linear(), nominal.rpy)};
  }
  result.text = ReplaceOrigins(urdf, source, result.calibrated);

  const RobotTree written = ParseUrdf(result.text, source + " (calibrated)");
  const double difference = LargestDifference(calibration, written, result.encoder_offsets);
  if (!(difference <= kGateTolerance)) {
    throw std::runtime_error(fmt::format(
        "the calibrated URDF differs from the calibrated model by {:.3g} m or rad (at most {:.0e} "
        "allowed); nothing was written",
        difference, kGateTolerance));
  }
  result.warnings = BrokenGeometry(model.tree, written);
  for (std::string& warning : UnrecordedBranches(model, changed)) {
    result.warnings.push_back(std::move(warning));
  }
  return result;
}

std::string MakeXacroOffsets(const CalibratedUrdf& calibrated) {
  tinyxml2::XMLPrinter xml;
  xml.PushHeader(false, true);
  xml.PushComment(
      calibrated.encoder_offsets.empty()
          ? " Written by elastocal. Metres and radians, to be added component by component to the "
            "nominal joint origins. The zero offsets of the joints are in these origins. "
          : " Written by elastocal. Metres and radians, to be added component by component to the "
            "nominal joint origins. The zero offsets of the joints are NOT in these origins but in "
            "JOINT_offset: position in the URDF = position of the controller + offset. ");
  xml.OpenElement("robot");
  xml.PushAttribute("xmlns:xacro", "http://www.ros.org/wiki/xacro");
  const auto add = [&](const std::string& name, double value) {
    xml.OpenElement("xacro:property");
    xml.PushAttribute("name", name.c_str());
    xml.PushAttribute("value", FormatNumber(value).c_str());
    xml.CloseElement();
  };
  static constexpr const char* kLengths[] = {"_x_offset", "_y_offset", "_z_offset"};
  static constexpr const char* kAngles[] = {"_roll_offset", "_pitch_offset", "_yaw_offset"};
  for (const auto& [joint, origin] : calibrated.calibrated) {
    const UrdfOrigin& nominal = calibrated.nominal.at(joint);
    for (int i = 0; i < 3; ++i) add(joint + kLengths[i], origin.xyz[i] - nominal.xyz[i]);
    for (int i = 0; i < 3; ++i) add(joint + kAngles[i], origin.rpy[i] - nominal.rpy[i]);
  }
  for (const auto& [joint, offset] : calibrated.encoder_offsets) add(joint + "_offset", offset);
  xml.CloseElement();
  return xml.CStr();
}

}  // namespace elastocal
