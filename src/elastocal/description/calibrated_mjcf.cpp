// SPDX-License-Identifier: Apache-2.0
#include "elastocal/description/calibrated_mjcf.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "elastocal/description/mjcf_defaults.hpp"
#include "elastocal/files/xml_edit.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr double kSamePlace = 1e-4;  // m and rad: tolerance of poses written with six digits
constexpr double kSameAxis = 1e-4;
constexpr double kSameRange = 0.01;  // tolerance of ranges written with three digits
// Inertia and damping of springs, as times, s (see simulation/mjcf.hpp).
constexpr double kSpringInertiaTime = 0.010, kSpringDampingTime = 0.020;

/// Pose of a joint's child link in the frame of the body that carries it, by the URDF.
Transform PoseInParent(const RobotTree& tree, std::size_t k, const MjcfBodies& bodies) {
  const Joint& joint = tree.joints[k];
  return bodies.CarrierFrame(tree, k).inverse() *
         tree.links[static_cast<std::size_t>(joint.parent_link)].T_body_link * joint.T_parent_child;
}

constexpr double kDegree = M_PI / 180.0;

/// The unit of the model's angles that it states, rad.
std::optional<double> StatedAngleUnit(const XmlElement& root) {
  std::optional<double> unit;
  for (const XmlElement& element : root.Children()) {
    if (element.Tag() != "compiler") continue;
    if (element.Has("coordinate") && element.Text("coordinate") == "global") {
      element.Fail("coordinate=\"global\"; bodies in the frames of their parents were expected");
    }
    if (element.Has("angle")) unit = element.Text("angle") == "radian" ? 1.0 : kDegree;
  }
  return unit;
}

XmlElement JointOf(const MjcfBody& body, const Joint& joint, const std::string& name,
                   const MjcfJointDefaults& defaults) {
  std::optional<XmlElement> found;
  for (const XmlElement& child : body.element.Children()) {
    if (child.Tag() == "joint" && child.Has("name") && child.Text("name") == name) found = child;
  }
  const auto giver = [&](const char* attribute) {
    return defaults.Giver(*found, body.childclass, attribute);
  };
  const auto position = giver("pos");
  if (position && position->Vector("pos").norm() > kSamePlace) {
    found->Fail("joint " + Quote(joint.name) + " is not in the origin of its body");
  }
  const auto typed = giver("type");
  const std::string type = typed ? typed->Text("type") : "hinge";
  const std::string expected = joint.type == JointType::kRevolute ? "hinge" : "slide";
  if (type != expected) {
    found->Fail("joint " + Quote(joint.name) + " is a " + type + "; that of the URDF, a " +
                expected + ", was expected");
  }
  const auto turned = giver("axis");
  const Eigen::Vector3d axis =
      turned ? turned->Vector("axis").normalized() : Eigen::Vector3d::UnitZ();
  if (!((axis - joint.axis).norm() < kSameAxis)) {
    found->Fail(fmt::format(
        "the axis of joint '{}' is ({:.4g} {:.4g} {:.4g}); that of the URDF, "
        "({:.4g} {:.4g} {:.4g}), was expected",
        joint.name, axis.x(), axis.y(), axis.z(), joint.axis.x(), joint.axis.y(), joint.axis.z()));
  }
  return *found;
}

/// The unit of angles in which ranges of joints are like the URDF's limits; nothing where none is.
std::optional<double> AngleUnitByRanges(const RobotTree& nominal, const MjcfBodies& bodies,
                                        const MjcfJointDefaults& defaults) {
  int radians = 0, degrees = 0;
  for (std::size_t k = 0; k < nominal.joints.size(); ++k) {
    const Joint& joint = nominal.joints[k];
    const Eigen::Vector2d limits(joint.limits.lower, joint.limits.upper);
    if (joint.type != JointType::kRevolute || !limits.allFinite()) continue;
    const MjcfBody& body = bodies.MovedBy(k);
    const auto giver = defaults.Giver(JointOf(body, joint, bodies.JointName(k), defaults),
                                      body.childclass, "range");
    if (!giver) continue;
    std::istringstream text(giver->Text("range"));
    Eigen::Vector2d range;
    if (!(text >> range[0] >> range[1])) continue;
    const auto is_like = [&](double unit) {
      return (unit * range - limits).norm() <= kSameRange * limits.norm();
    };
    radians += is_like(1.0);
    degrees += is_like(kDegree);
  }
  if (radians == degrees) return std::nullopt;
  return radians > degrees ? 1.0 : kDegree;
}

/// The unit of the angles of a model that states none, rad: that in which ranges of joints are like
/// the URDF's limits. MuJoCo's default (degrees) does not count where another file includes this
/// one.
double UnstatedAngleUnit(const XmlElement& root, const RobotTree& nominal, const MjcfBodies& bodies,
                         const MjcfJointDefaults& defaults) {
  if (const auto like_limits = AngleUnitByRanges(nominal, bodies, defaults)) return *like_limits;
  root.Fail(
      "the unit of angles is unknown: there is neither <compiler angle=\"...\"> nor a joint whose "
      "range is like the URDF's limits; add <compiler angle=\"radian\"/> or "
      "<compiler angle=\"degree\"/>, as the file that includes this one has it");
}

void CheckNominal(const MjcfBody& body, const Joint& joint, const Transform& expected) {
  const Transform off = expected.inverse() * ReadBodyPose(body.element);
  const double turn = RotationAngle(off.linear());
  if (off.translation().norm() <= kSamePlace && turn <= kSamePlace) return;
  body.element.Fail(fmt::format(
      "the body that joint '{}' moves is {:.3g} mm and {:.3g} deg from where the URDF that was "
      "calibrated has it",
      joint.name, 1e3 * off.translation().norm(), turn * 180.0 / M_PI));
}

/// Inserts text in front of an element, on lines of its own.
XmlEdit InFrontOf(const std::string& text, const XmlElement& element, const std::string& lines) {
  const std::size_t begin = element.Begin();
  std::size_t line = begin;
  while (line > 0 && (text[line - 1] == ' ' || text[line - 1] == '\t')) --line;
  return {begin, 0, lines + "\n" + text.substr(line, begin - line)};
}

std::string WriteQuaternion(const Eigen::Matrix3d& R) {
  Eigen::Quaterniond quaternion(R);
  if (quaternion.w() < 0.0) quaternion.coeffs() *= -1.0;
  return FormatNumber(quaternion.w()) + " " + WriteVector(quaternion.vec());
}

/// By coordinate, what is added to the position of its encoder.
Eigen::VectorXd ByCoordinate(const RobotTree& tree, const std::map<std::string, double>& offsets) {
  Eigen::VectorXd by_coordinate = Eigen::VectorXd::Zero(tree.coordinate_count());
  for (const auto& [name, offset] : offsets) {
    const int joint = FindJoint(tree, name);
    by_coordinate[tree.joints[static_cast<std::size_t>(joint)].coordinate] = offset;
  }
  return by_coordinate;
}

std::vector<SeriesSpring> SpringsOf(const std::vector<SeriesSpring>& springs, std::size_t joint) {
  std::vector<SeriesSpring> found;
  for (const SeriesSpring& spring : springs) {
    if (spring.joint == static_cast<int>(joint)) found.push_back(spring);
  }
  return found;
}

/// Puts springs into a model.
class SpringWriter {
 public:
  /// `angle_unit`: of the model's angles, rad.
  SpringWriter(const std::string& text, const XmlElement& root, double angle_unit)
      : text_(text), root_(root), angle_unit_(angle_unit) {
    CheckKeyframes();
    CollectNames(root);
  }

  /// Adds the springs of one joint. `T_parent_root` is the pose of the root link in the body that
  /// carries the joint's body. Returns whether the body now is in new bodies, whose frame is that
  /// of the root link.
  bool Add(const std::vector<SeriesSpring>& springs, const MjcfBody& body,
           const std::string& carrier, const XmlElement& motor, const Transform& T_parent_root) {
    std::map<SpringPlace, std::string> joints;
    for (const SeriesSpring& spring : springs) joints[spring.place] += SpringText(spring);
    if (joints.contains(SpringPlace::kJoint)) {
      edits_.push_back(InFrontOf(text_, motor, joints[SpringPlace::kJoint]));
    }
    // The spring of a sole comes after the motor: it turns with the foot.
    if (joints.contains(SpringPlace::kSole)) {
      edits_.push_back({motor.End(), 0, joints[SpringPlace::kSole]});
    }
    // One body takes six joints at most: root link and leg get bodies of their own.
    const std::string name = body.element.Text("name");
    std::string begin, end;
    for (const auto& [place, what] : {std::pair{SpringPlace::kLeg, "_leg_elastic"},
                                      std::pair{SpringPlace::kRootLink, "_root_elastic"}}) {
      if (!joints.contains(place)) continue;
      begin += BodyText(Fresh(name + what), end.empty() ? T_parent_root : Transform::Identity()) +
               joints[place];
      end += "</body>";
    }
    if (end.empty()) return false;
    edits_.push_back(InFrontOf(text_, body.element, begin));
    ends_.push_back({body.element.End(), 0, end});
    // MuJoCo lets a body and the one that carries it pass through each other.
    if (!carrier.empty()) {
      excluded_ += "<exclude body1=\"" + carrier + "\" body2=\"" + name + "\"/>";
    }
    return true;
  }

  /// The ends of new bodies come first, so that the next body begins behind them.
  std::vector<XmlEdit> Edits() && {
    if (!excluded_.empty()) {
      ends_.push_back(InsertElement(text_, root_, "<contact>" + excluded_ + "</contact>"));
    }
    ends_.insert(ends_.end(), edits_.begin(), edits_.end());
    return std::move(ends_);
  }

 private:
  /// MuJoCo's keyframes have one number for each degree of freedom.
  void CheckKeyframes() const {
    for (const XmlElement& section : root_.Children()) {
      if (section.Tag() != "keyframe") continue;
      for (const XmlElement& key : section.Children()) {
        if (key.Has("qpos") || key.Has("qvel")) {
          key.Fail(
              "a keyframe holds the positions of all joints, and springs add joints; a model "
              "without keyframes was expected");
        }
      }
    }
  }

  void CollectNames(const XmlElement& within) {
    for (const XmlElement& child : within.Children()) {
      if (child.Has("name")) names_.insert(child.Text("name"));
      CollectNames(child);
    }
  }

  std::string Fresh(const std::string& name) const {
    if (names_.contains(name)) {
      root_.Fail("the model has something called " + Quote(name) + ", as a spring would be called");
    }
    return name;
  }

  /// The beginning of a body that weighs nothing.
  static std::string BodyText(const std::string& name, const Transform& T) {
    return "<body name=\"" + name + "\" pos=\"" + WriteVector(T.translation()) + "\" quat=\"" +
           WriteQuaternion(T.linear()) +
           R"("><inertial pos="0 0 0" mass="1e-6" diaginertia="1e-7 1e-7 1e-7"/>)";
  }

  /// Its inertia and damping make it critically damped by itself, whatever its stiffness.
  std::string SpringText(const SeriesSpring& spring) const {
    std::string name = spring.name;  // JOINT.compliance_x: JOINT_elastic_x
    name.replace(name.rfind('.'), std::string(".compliance").size(), "_elastic");
    const double stiffness = 1.0 / spring.compliance;
    return fmt::format(
        "<joint name=\"{}\" type=\"{}\" axis=\"{}\" pos=\"{}\" stiffness=\"{}\" damping=\"{}\" "
        "armature=\"{}\" springref=\"{}\" ref=\"0\" limited=\"false\" frictionloss=\"0\"/>",
        Fresh(name), spring.slides ? "slide" : "hinge", WriteVector(spring.axis),
        WriteVector(spring.anchor), FormatNumber(stiffness),
        FormatNumber(stiffness * kSpringDampingTime),
        FormatNumber(stiffness * kSpringInertiaTime * kSpringInertiaTime),
        FormatNumber(spring.unloaded / (spring.slides ? 1.0 : angle_unit_) + 0.0));  // no -0
  }

  const std::string& text_;
  const XmlElement& root_;
  double angle_unit_;
  std::set<std::string> names_;
  std::vector<XmlEdit> edits_, ends_;
  std::string excluded_;
};

}  // namespace

std::string MakeCalibratedMjcf(const std::string& mjcf, const std::string& source,
                               const RobotTree& nominal, const RobotTree& calibrated,
                               const std::map<std::string, double>& encoder_offsets,
                               const std::vector<SeriesSpring>& springs,
                               const MjcfJointNames& joint_names) {
  const XmlText xml(mjcf, source);
  const XmlElement root = xml.Root();
  if (root.Tag() != "mujoco") {
    root.Fail("found <" + std::string(root.Tag()) + ">; an MJCF model, <mujoco>, was expected");
  }
  const MjcfBodies bodies(root, nominal, joint_names);
  const MjcfJointDefaults defaults(root);
  const std::optional<double> stated = StatedAngleUnit(root);
  const bool has_angles =
      !springs.empty() ||
      std::ranges::any_of(encoder_offsets, [](const auto& offset) { return offset.second != 0.0; });
  const double angle_unit = stated       ? *stated
                            : has_angles ? UnstatedAngleUnit(root, nominal, bodies, defaults)
                                         : 1.0;  // nothing is written that has a unit
  const Eigen::VectorXd offsets = ByCoordinate(nominal, encoder_offsets);
  std::vector<XmlEdit> edits;
  std::optional<SpringWriter> writer;
  if (!springs.empty()) writer.emplace(mjcf, root, angle_unit);
  for (std::size_t k = 0; k < nominal.joints.size(); ++k) {
    const Joint& joint = nominal.joints[k];
    const MjcfBody& body = bodies.MovedBy(k);
    CheckNominal(body, joint, PoseInParent(nominal, k, bodies));
    const XmlElement element = JointOf(body, joint, bodies.JointName(k), defaults);
    Transform T = PoseInParent(calibrated, k, bodies);
    if (writer) {
      const Transform T_parent_root = bodies.CarrierFrame(nominal, k).inverse();
      if (writer->Add(SpringsOf(springs, k), body, bodies.CarrierName(body), element,
                      T_parent_root)) {
        T = T_parent_root.inverse() * T;  // carried by the root link's own part now
      }
    }
    edits.push_back(SetAttribute(body.element, "pos", WriteVector(T.translation())));
    edits.push_back(SetAttribute(body.element, "quat", WriteQuaternion(T.linear())));
    // A mimic joint has no encoder and shows what those of its leaders say. With its `ref`, an
    // equality of the model holds as before, because MuJoCo counts both joints from theirs.
    const double offset = JointRate(joint, offsets);
    if (offset == 0.0) continue;
    const double unit = joint.type == JointType::kRevolute ? angle_unit : 1.0;
    const auto given = defaults.Giver(element, body.childclass, "ref");
    const double ref = given ? given->Number("ref") : 0.0;
    edits.push_back(SetAttribute(element, "ref", FormatNumber(ref - offset / unit)));
  }
  if (!writer) return ApplyEdits(mjcf, std::move(edits));
  std::vector<XmlEdit> all = std::move(*writer).Edits();
  all.insert(all.end(), edits.begin(), edits.end());
  return ApplyEdits(mjcf, std::move(all));
}

}  // namespace elastocal
