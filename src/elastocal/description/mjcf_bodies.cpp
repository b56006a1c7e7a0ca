// SPDX-License-Identifier: Apache-2.0
#include "elastocal/description/mjcf_bodies.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

/// The first file that a part of the model is in.
std::optional<std::string> FindInclude(const XmlElement& within) {
  for (const XmlElement& child : within.Children()) {
    if (child.Tag() == "include" && child.Has("file")) return child.Text("file");
    if (auto found = FindInclude(child)) return found;
  }
  return {};
}

[[noreturn]] void FailWithoutJoint(const XmlElement& root, const std::string& joint,
                                   const std::string& name, const std::vector<std::string>& names) {
  const std::string missing =
      "no body has a joint " + Quote(name) +
      (joint == name ? "" : ", as joint " + Quote(joint) + " of the URDF is to be called");
  if (const auto file = FindInclude(root)) {
    root.Fail(missing + ", in this file; it includes " + Quote(*file) +
              ": give the file that has the bodies, or the whole model as MuJoCo saves it");
  }
  root.Fail(missing +
            "; joints with the names of the URDF's were expected, or others by --mjcf-joints" +
            DidYouMean(name, names));
}

Eigen::Quaterniond ReadQuaternion(const XmlElement& body) {
  for (const char* other : {"euler", "axisangle", "xyaxes", "zaxis"}) {
    if (body.Has(other)) {
      body.Fail(std::string("orientation by '") + other +
                "'; 'quat' was expected, as MuJoCo saves models");
    }
  }
  if (!body.Has("quat")) return Eigen::Quaterniond::Identity();
  const std::string text = body.Text("quat");
  std::array<double, 4> numbers{};
  std::string_view rest = Trim(text);
  for (double& number : numbers) {
    const std::string_view word = rest.substr(0, rest.find_first_of(" \t\r\n"));
    const std::optional<double> value = ParseNumber(word);
    rest = Trim(rest.substr(word.size()));
    if (!value) body.Fail("quat is " + Quote(text) + "; four finite numbers were expected");
    number = *value;
  }
  const Eigen::Quaterniond quaternion(numbers[0], numbers[1], numbers[2], numbers[3]);
  if (!rest.empty() || !(quaternion.norm() > 0.1)) {
    body.Fail("quat is " + Quote(text) + "; four numbers w x y z were expected");
  }
  return quaternion.normalized();
}

/// The part of a name for which the `*` of `pattern` stands, or the name itself without `*`;
/// nothing if the pattern does not fit.
std::optional<std::string> RestOf(const std::string& name, const std::string& pattern) {
  const std::size_t star = pattern.find('*');
  if (star == std::string::npos) {
    return name == pattern ? std::optional<std::string>(name) : std::nullopt;
  }
  const std::string_view begin = std::string_view(pattern).substr(0, star),
                         end = std::string_view(pattern).substr(star + 1);
  if (name.size() < begin.size() + end.size() || !name.starts_with(begin) || !name.ends_with(end)) {
    return std::nullopt;
  }
  return name.substr(begin.size(), name.size() - begin.size() - end.size());
}

}  // namespace

Transform ReadBodyPose(const XmlElement& body) {
  Transform T = Transform::Identity();
  if (body.Has("pos")) T.translation() = body.Vector("pos");
  T.linear() = ReadQuaternion(body).toRotationMatrix();
  return T;
}

MjcfJointNames ReadMjcfJointNames(const RobotTree& tree, const std::vector<std::string>& rules) {
  MjcfJointNames names;
  for (const std::string& rule : rules) {
    const std::size_t equals = rule.find('=');
    const std::string from = rule.substr(0, equals);
    const std::string to = equals == std::string::npos ? "" : rule.substr(equals + 1);
    const auto stars = [](const std::string& text) {
      return std::count(text.begin(), text.end(), '*');
    };
    if (from.empty() || to.empty() || stars(from) > 1 || stars(from) != stars(to)) {
      throw InputError("--mjcf-joints " + Quote(rule) +
                       ": URDF_JOINT=MJCF_JOINT was expected, or the same with one * on each side");
    }
    bool fits = false;
    for (const Joint& joint : tree.joints) {
      const auto rest = RestOf(joint.name, from);
      if (!rest) continue;
      fits = true;
      const std::size_t star = to.find('*');
      names.emplace(joint.name,
                    star == std::string::npos ? to : std::string(to).replace(star, 1, *rest));
    }
    if (fits) continue;
    std::vector<std::string> known;
    for (const Joint& joint : tree.joints) known.push_back(joint.name);
    throw InputError("--mjcf-joints " + Quote(rule) + ": the URDF has no such joint" +
                     DidYouMean(from, known));
  }
  return names;
}

MjcfBodies::MjcfBodies(const XmlElement& mujoco, const RobotTree& tree,
                       const MjcfJointNames& names) {
  if (const auto world = mujoco.FindFirst("worldbody")) Collect(*world, -1, "");
  std::map<std::string, int> moved;  // by joint of the MJCF
  std::vector<std::string> known;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (const XmlElement& child : bodies_[b].element.Children()) {
      if (child.Tag() != "joint" && child.Tag() != "freejoint") continue;
      bodies_[b].moves = true;
      if (!child.Has("name")) continue;
      known.push_back(child.Text("name"));
      moved.emplace(known.back(), static_cast<int>(b));
    }
  }
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    const std::string& joint = tree.joints[k].name;
    const auto renamed = names.find(joint);
    joint_names_.push_back(renamed == names.end() ? joint : renamed->second);
    const auto found = moved.find(joint_names_.back());
    if (found == moved.end()) FailWithoutJoint(mujoco, joint, joint_names_.back(), known);
    MjcfBody& body = bodies_[static_cast<std::size_t>(found->second)];
    if (body.joint >= 0) {
      body.element.Fail("joints " + Quote(tree.joints[static_cast<std::size_t>(body.joint)].name) +
                        " and " + Quote(joint) +
                        " move one body; a body for each, as in the URDF, was expected");
    }
    body.joint = static_cast<int>(k);
    body_of_.push_back(found->second);
  }
}

void MjcfBodies::Collect(const XmlElement& within, int parent, const std::string& childclass) {
  for (const XmlElement& child : within.Children()) {
    if (child.Tag() != "body") continue;
    const std::string own = child.Has("childclass") ? child.Text("childclass") : childclass;
    const auto index = static_cast<int>(bodies_.size());
    bodies_.push_back({child, parent, own});
    Collect(child, index, own);
  }
}

std::string MjcfBodies::CarrierName(const MjcfBody& body) const {
  return body.parent < 0 ? "" : bodies_[static_cast<std::size_t>(body.parent)].Name();
}

MjcfBodies::Frame MjcfBodies::FrameOf(const RobotTree& tree, int body) const {
  if (body < 0) return {};
  const MjcfBody& found = bodies_[static_cast<std::size_t>(body)];
  if (found.joint >= 0) {
    const Joint& joint = tree.joints[static_cast<std::size_t>(found.joint)];
    const Link& link = tree.links[static_cast<std::size_t>(joint.child_link)];
    return {link.body, link.T_body_link};
  }
  const std::string name = found.Name();
  for (const Link& link : tree.links) {
    if (link.name == name) return {link.body, link.T_body_link};
  }
  if (found.moves || found.parent < 0) return {};
  const Frame carrier = FrameOf(tree, found.parent);
  return {carrier.body, carrier.T_body * ReadBodyPose(found.element)};
}

Transform MjcfBodies::CarrierFrame(const RobotTree& tree, std::size_t joint) const {
  const MjcfBody& body = bodies_[BodyOf(joint)];
  const Frame frame = FrameOf(tree, body.parent);
  const Link& carrier = tree.links[static_cast<std::size_t>(tree.joints[joint].parent_link)];
  if (frame.body != carrier.body) {
    body.element.Fail("the body of joint " + Quote(tree.joints[joint].name) + " is carried by " +
                      Quote(CarrierName(body)) + "; " + Quote(carrier.name) +
                      " or a link fixed to it was expected");
  }
  return frame.T_body;
}

}  // namespace elastocal
