// SPDX-License-Identifier: Apache-2.0
#include "elastocal/description/calibrated_urdf.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/robot/coupling.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/robot/linkage_errors.hpp"
#include "elastocal/robot/special_geometry.hpp"
#include "elastocal/tables/text.hpp"

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

bool IsActive(const ErrorModel& model, int joint) {
  return std::binary_search(model.active_joints.begin(), model.active_joints.end(), joint);
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

/// Zero offsets that go to the encoders, by joint. A mimic joint has no encoder.
std::map<std::string, double> EncoderOffsets(const CalibrationResult& calibration) {
  const ErrorModel& model = calibration.model;
  std::map<std::string, double> offsets;
  for (int i = 0; i < model.parameter_count(); ++i) {
    if (!IsZeroOffset(model.tree, model.parameters[i])) continue;
    const Joint& joint = model.tree.joints[model.parameters[i].joint];
    if (!joint.mimic) offsets[joint.name] = calibration.delta[i];
  }
  return offsets;
}

/// The offsets of the encoders as a controller adds them: one for each entry of q.
Eigen::VectorXd CoordinateOffsets(const RobotTree& tree,
                                  const std::map<std::string, double>& encoder_offsets) {
  Eigen::VectorXd offsets = Eigen::VectorXd::Zero(tree.coordinate_count());
  for (const auto& [joint, offset] : encoder_offsets) {
    offsets[tree.joints[FindJoint(tree, joint)].coordinate] = offset;
  }
  return offsets;
}

/// New origins, by joint, with which the URDF is the calibrated robot when `q_offset` is added to
/// q. A mimic joint also moves by its leader's offset. Its origin therefore contains the difference
/// to its own zero offset, which is zero if it carries no marker.
std::map<int, Transform> ChangedOrigins(const CalibrationResult& calibration,
                                        const Eigen::VectorXd& q_offset) {
  const ErrorModel& model = calibration.model;
  const auto offset = [&](const Joint& joint) { return JointRate(joint, q_offset); };
  Eigen::VectorXd in_origins = calibration.delta;
  std::set<int> changed;
  for (int i = 0; i < model.parameter_count(); ++i) {
    const Parameter& parameter = model.parameters[i];
    if (parameter.joint < 0 || IsElastic(parameter.kind)) continue;
    if (IsZeroOffset(model.tree, parameter)) {
      in_origins[i] -= offset(model.tree.joints[parameter.joint]);
    }
    if (in_origins[i] != 0.0) changed.insert(parameter.joint);
  }
  const Geometry geometry = ApplyErrors(model, in_origins);
  std::map<int, Transform> origins;
  for (int k : changed) origins[k] = CalibratedOrigin(model, geometry, k);
  for (int k = 0; k < static_cast<int>(model.tree.joints.size()); ++k) {
    const Joint& joint = model.tree.joints[k];
    if (IsActive(model, k) || offset(joint) == 0.0) continue;
    origins[k] =
        joint.T_parent_child * (joint.type == JointType::kRevolute
                                    ? RotAxis(joint.axis, -offset(joint))
                                    : Transform(Eigen::Translation3d(-offset(joint) * joint.axis)));
  }
  return origins;
}

/// The origin in the form of a URDF; rounding errors near zero become zero.
UrdfOrigin ToOrigin(const Transform& T, const Eigen::Vector3d& nominal_rpy) {
  constexpr double kDust = 1e-15;  // m and rad
  const auto clean = [](double value) { return std::abs(value) < kDust ? 0.0 : value; };
  return {T.translation().unaryExpr(clean), ToRpy(T.linear(), nominal_rpy).unaryExpr(clean)};
}

/// Poses of all links in the frame of the waist, by the calibrated model; joints that carry no
/// marker have no errors and move as nominal. `placed` is q with the joints of linkages where the
/// rods with errors put them.
std::vector<Transform> CalibratedLinks(const ErrorModel& model, const Geometry& geometry,
                                       const Eigen::VectorXd& q, const Eigen::VectorXd& placed) {
  const RobotTree& tree = model.tree;
  const std::vector<Transform> T_ref_body = BodyTransforms(model, geometry, q);
  const std::vector<Transform> T_root_nominal = LinkTransforms(tree, placed);
  std::vector<Transform> T_waist_body(tree.body_count(), Transform::Identity());
  for (int k = 0; k < static_cast<int>(tree.joints.size()); ++k) {
    const Joint& joint = tree.joints[k];
    T_waist_body[k + 1] =
        IsActive(model, k)
            ? T_ref_body[0].inverse() * T_ref_body[k + 1]
            : T_waist_body[joint.parent_body] * tree.links[joint.parent_link].T_body_link *
                  T_root_nominal[joint.parent_link].inverse() * T_root_nominal[joint.child_link];
  }
  std::vector<Transform> T_waist_link;
  for (const Link& link : tree.links) {
    T_waist_link.push_back(T_waist_body[link.body] * link.T_body_link);
  }
  return T_waist_link;
}

/// Largest difference between the written URDF at positions q + q_offset and the calibrated model
/// at q, waist to links. Positions of linkages are those that the calibrated rods give.
double LargestDifference(const CalibrationResult& calibration, const RobotTree& written,
                         const Eigen::VectorXd& q_offset) {
  const ErrorModel& model = calibration.model;
  const Geometry geometry = ApplyErrors(model, calibration.delta);
  Random random(1);
  double largest = 0.0;
  for (int i = 0; i < kGatePostures; ++i) {
    const Eigen::VectorXd q = RandomPosture(model.tree, random);
    const Eigen::VectorXd placed = PlaceLinkages(model.tree, geometry.linkage_errors, q).q;
    const std::vector<Transform> expected = CalibratedLinks(model, geometry, q, placed);
    const std::vector<Transform> found = LinkTransforms(written, placed + q_offset);
    for (std::size_t link = 0; link < expected.size(); ++link) {
      const Transform T = expected[link].inverse() * found[link];
      largest = std::max({largest, T.translation().norm(), RotationAngle(T.linear())});
    }
  }
  return largest;
}

/// Warnings about exact relations of axes that the calibration breaks so far that inverse
/// kinematics in closed form is off by half a millimetre: of a wrist by this distance, of parallel
/// axes by the angle that gives it over half a metre.
std::vector<std::string> BrokenGeometry(const RobotTree& nominal, const RobotTree& calibrated) {
  constexpr double kBrokenWrist = 0.5e-3;   // m
  constexpr double kBrokenParallel = 1e-3;  // rad
  std::vector<std::string> warnings;
  for (const SpecialGeometry& group : FindSpecialGeometry(nominal)) {
    const double deviation = Deviation(calibrated, group);
    const bool wrist = group.kind == SpecialGeometry::Kind::kSphericalWrist;
    if (deviation <= (wrist ? kBrokenWrist : kBrokenParallel)) continue;
    std::string names;
    for (int joint : group.joints) {
      names += (names.empty() ? "" : ", ") + nominal.joints[joint].name;
    }
    warnings.push_back(
        wrist
            ? fmt::format("the axes of {} no longer meet in a point ({:.3f} mm apart): inverse "
                          "kinematics in closed form that relies on it is off by as much",
                          names, 1e3 * deviation)
            : fmt::format("the axes of {} are no longer parallel ({:.3f} deg): inverse kinematics "
                          "in closed form that relies on it is off by as much",
                          names, deviation * 180.0 / M_PI));
  }
  return warnings;
}

/// Warnings about corrections of joints that carry a branch with markers and others without: the
/// latter are moved as well, although nothing was measured there.
std::vector<std::string> UnrecordedBranches(const CalibrationResult& calibration) {
  const ErrorModel& model = calibration.model;
  std::set<int> changed;
  for (int i = 0; i < model.parameter_count(); ++i) {
    if (calibration.delta[i] != 0.0) changed.insert(model.parameters[i].joint);
  }
  std::vector<std::string> warnings;
  for (int k : model.active_joints) {
    std::string unrecorded;
    bool branches = false;
    for (int i = 0; i < static_cast<int>(model.tree.joints.size()); ++i) {
      if (model.tree.joints[i].parent_body != k + 1) continue;
      if (IsActive(model, i)) {
        branches = true;
      } else {
        unrecorded += (unrecorded.empty() ? "" : ", ") + model.tree.joints[i].name;
      }
    }
    if (!changed.contains(k) || !branches || unrecorded.empty()) continue;
    warnings.push_back(
        fmt::format("the correction of {} also moves what {} {}, of which this recording shows "
                    "nothing: it may belong to the recorded branch alone",
                    model.tree.joints[k].name, unrecorded,
                    unrecorded.find(',') == std::string::npos ? "carries" : "carry"));
  }
  return warnings;
}

}  // namespace

CalibratedUrdf MakeCalibratedUrdf(const std::string& urdf, const std::string& source,
                                  const CalibrationResult& calibration, ZeroOffsets zero_offsets) {
  const ErrorModel& model = calibration.model;
  const std::map<std::string, UrdfOrigin> origins = ReadOrigins(urdf, source);
  CalibratedUrdf result;
  if (zero_offsets == ZeroOffsets::kEncoder) result.encoder_offsets = EncoderOffsets(calibration);
  const Eigen::VectorXd q_offset = CoordinateOffsets(model.tree, result.encoder_offsets);
  const std::map<int, Transform> changed = ChangedOrigins(calibration, q_offset);
  for (const auto& [k, T_parent_child] : changed) {
    const std::string& name = model.tree.joints[k].name;
    result.nominal[name] = origins.at(name);
    result.calibrated[name] = ToOrigin(T_parent_child, origins.at(name).rpy);
  }
  result.text = ReplaceOrigins(urdf, source, result.calibrated);

  RobotTree written = ParseUrdf(result.text, source + " (calibrated)");
  CopyDrives(model.tree, written);  // couplings are not in a URDF
  const double difference = LargestDifference(calibration, written, q_offset);
  if (!(difference <= kGateTolerance)) {
    throw std::runtime_error(fmt::format(
        "the calibrated URDF differs from the calibrated model by {:.3g} m or rad (at most {:.0e} "
        "allowed); nothing was written",
        difference, kGateTolerance));
  }
  result.warnings = BrokenGeometry(model.tree, written);
  for (std::string& warning : UnrecordedBranches(calibration)) {
    result.warnings.push_back(std::move(warning));
  }
  return result;
}

namespace {

constexpr std::array kXacroOffsets = {"_x_offset",     "_y_offset",   "_z_offset", "_roll_offset",
                                      "_pitch_offset", "_yaw_offset", "_offset"};

/// Beginning of the property names of each joint: names of xacro have only letters, digits and '_'.
/// If a property would have the name of another joint's property, a number is added.
std::map<std::string, std::string> XacroNames(const CalibratedUrdf& calibrated) {
  std::set<std::string> joints, taken;
  for (const auto& [joint, origin] : calibrated.calibrated) joints.insert(joint);
  for (const auto& [joint, offset] : calibrated.encoder_offsets) joints.insert(joint);
  const auto as_property = [](std::string name) {
    for (char& c : name) {
      if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    }
    return std::isdigit(static_cast<unsigned char>(name.front())) ? '_' + name : name;
  };
  const auto properties_of = [&](const std::string& joint, const std::string& name) {
    std::vector<std::string> properties;
    for (const char* ending : kXacroOffsets) {
      const bool of_encoder = ending == kXacroOffsets.back();
      const bool has = of_encoder ? calibrated.encoder_offsets.contains(joint)
                                  : calibrated.calibrated.contains(joint);
      if (has) properties.push_back(name + ending);
    }
    return properties;
  };
  const auto is_free = [&](const std::string& property) { return !taken.contains(property); };
  std::map<std::string, std::string> names;
  for (const bool as_it_is : {true, false}) {  // first the joints that keep their names
    for (const std::string& joint : joints) {
      const std::string property = as_property(joint);
      if ((property == joint) != as_it_is) continue;
      std::string name = property;
      std::vector<std::string> all = properties_of(joint, name);
      for (int i = 2; !std::all_of(all.begin(), all.end(), is_free); ++i) {
        name = property + "_" + std::to_string(i);
        all = properties_of(joint, name);
      }
      taken.insert(all.begin(), all.end());
      names[joint] = name;
    }
  }
  return names;
}

}  // namespace

std::string MakeXacroOffsets(const CalibratedUrdf& calibrated) {
  pugi::xml_document xml;
  pugi::xml_node declaration = xml.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  xml.append_child(pugi::node_comment)
      .set_value(calibrated.encoder_offsets.empty()
                     ? " Written by elastocal. Metres and radians, to be added component by "
                       "component to the nominal joint origins. The zero offsets of the joints are "
                       "in these origins. "
                     : " Written by elastocal. Metres and radians, to be added component by "
                       "component to the nominal joint origins. The zero offsets of the joints are "
                       "NOT in these origins but in JOINT_offset: position in the URDF = position "
                       "of the controller + offset. ");
  pugi::xml_node robot = xml.append_child("robot");
  robot.append_attribute("xmlns:xacro") = "http://www.ros.org/wiki/xacro";
  const std::map<std::string, std::string> properties = XacroNames(calibrated);
  for (const auto& [joint, name] : properties) {
    if (name == joint) continue;
    robot.append_child(pugi::node_comment)
        .set_value((" joint '" + joint + "': " + name + "_... ").c_str());
  }
  const auto add = [&](const std::string& name, double value) {
    pugi::xml_node property = robot.append_child("xacro:property");
    property.append_attribute("name") = name.c_str();
    property.append_attribute("value") = FormatNumber(value).c_str();
  };
  for (const auto& [joint, origin] : calibrated.calibrated) {
    const UrdfOrigin& nominal = calibrated.nominal.at(joint);
    for (std::size_t i = 0; i < 6; ++i) {
      const auto k = static_cast<Eigen::Index>(i % 3);
      add(properties.at(joint) + kXacroOffsets[i],
          i < 3 ? origin.xyz[k] - nominal.xyz[k] : origin.rpy[k] - nominal.rpy[k]);
    }
  }
  for (const auto& [joint, offset] : calibrated.encoder_offsets) {
    add(properties.at(joint) + kXacroOffsets.back(), offset);
  }
  std::ostringstream stream;
  xml.save(stream, "  ");
  return stream.str();
}

}  // namespace elastocal
