#include "elastocal/drafting/body_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "elastocal/drafting/primitive.hpp"
#include "elastocal/io/urdf_outline.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr double kLeastDensity = 20.0;   // kg/m^3: foam
constexpr double kUsualDensity = 900.0;  // kg/m^3: of a robot's link, motors and hollows together

/// The primitive of an element `collision` or `visual`; nothing for a mesh.
std::optional<Primitive> ReadPrimitive(const XmlElement& element, const Transform& T_body_link) {
  const auto geometry = element.Find("geometry");
  if (!geometry) return std::nullopt;
  Primitive shape;
  if (const auto box = geometry->Find("box")) {
    shape.half = 0.5 * box->Vector("size");
  } else if (const auto cylinder = geometry->Find("cylinder")) {
    shape.kind = Primitive::Kind::kCylinder;
    const double radius = cylinder->Number("radius");
    shape.half = {radius, radius, 0.5 * cylinder->Number("length")};
  } else if (const auto sphere = geometry->Find("sphere")) {
    shape.kind = Primitive::Kind::kSphere;
    shape.half.setConstant(sphere->Number("radius"));
  } else {
    return std::nullopt;
  }
  const UrdfOrigin origin = ReadUrdfOrigin(element);
  shape.T_body_shape = T_body_link * FromXyzRpy(origin.xyz, origin.rpy);
  return shape;
}

std::vector<Primitive> ReadPrimitives(const XmlElement& link, const Transform& T_body_link) {
  for (const char* purpose : {"collision", "visual"}) {
    std::vector<Primitive> shapes;
    for (const XmlElement& element : link.Children()) {
      if (element.Tag() != purpose) continue;
      if (const auto shape = ReadPrimitive(element, T_body_link)) shapes.push_back(*shape);
    }
    if (!shapes.empty()) return shapes;
  }
  return {};
}

/// The points of shapes that are not inside another of them.
std::vector<Eigen::Vector3d> OuterPoints(const std::vector<Primitive>& shapes) {
  constexpr double kDepth = 1e-6;
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    for (const Eigen::Vector3d& point : SurfacePoints(shapes[i])) {
      const bool hidden = std::any_of(shapes.begin(), shapes.end(), [&](const Primitive& other) {
        return &other != &shapes[i] && other.Contains(point, kDepth);
      });
      if (!hidden) points.push_back(point);
    }
  }
  return points;
}

struct BodyMass {
  double mass = 0.0;
  Eigen::Vector3d com = Eigen::Vector3d::Zero();  ///< in the body's frame, m
};

BodyMass MassOf(const RobotTree& tree, int body) {
  BodyMass sum;
  for (const Link& link : tree.links) {
    if (link.body != body) continue;
    sum.mass += link.mass;
    sum.com += link.mass * (link.T_body_link * link.com);
  }
  if (sum.mass > 0.0) sum.com /= sum.mass;
  return sum;
}

/// Rods from the body's origin to the joints that it carries or, at the end of a limb, through its
/// centre of mass as far again. Their volume is that of the mass.
std::vector<Eigen::Vector3d> GuessPoints(const RobotTree& tree, int body, double longest) {
  const BodyMass mass = MassOf(tree, body);
  std::vector<Eigen::Vector3d> ends;
  for (const Joint& joint : tree.joints) {
    if (joint.parent_body != body) continue;
    ends.emplace_back(tree.links[Size(joint.parent_link)].T_body_link *
                      joint.T_parent_child.translation());
  }
  constexpr double kShort = 0.02;
  double length = 0.0;
  for (const Eigen::Vector3d& end : ends) length += end.norm();
  if (length < kShort * longest) {
    Eigen::Vector3d end = 2.0 * mass.com;
    if (end.norm() > 0.3 * longest) end *= 0.3 * longest / end.norm();
    ends.push_back(end);
    length += end.norm();
  }
  double radius = 0.12 * longest;
  while (radius > 0.015 * longest &&
         std::numbers::pi * radius * radius * (length + 4.0 / 3.0 * radius) >
             mass.mass / kUsualDensity) {
    radius *= 0.98;
  }
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3d& end : ends) {
    for (const Eigen::Vector3d& p : RodPoints(Eigen::Vector3d::Zero(), end, radius)) {
      points.push_back(p);
    }
  }
  return points;
}

}  // namespace

RobotShapes ReadBodyShapes(const RobotTree& tree, const std::string& text,
                           const std::string& source) {
  const XmlText xml(text, source);
  const UrdfOutline outline = ReadUrdfOutline(xml);
  std::vector<std::vector<Primitive>> shapes(Size(tree.body_count()));
  RobotShapes result;
  for (const UrdfLink& described : outline.links) {
    const auto link =
        std::find_if(tree.links.begin(), tree.links.end(),
                     [&](const Link& candidate) { return candidate.name == described.name; });
    if (link == tree.links.end()) continue;
    for (const Primitive& shape : ReadPrimitives(described.element, link->T_body_link)) {
      if (link->mass > 0.0 && link->mass < kLeastDensity * shape.Volume()) {
        result.warnings.push_back("link " + Quote(link->name) + ": a shape of " +
                                  FormatNumber(std::round(1e3 * shape.Volume())) +
                                  " litres is left out, the link has only " +
                                  FormatNumber(link->mass) + " kg");
        continue;
      }
      shapes[Size(link->body)].push_back(shape);
    }
  }
  const double longest = LongestBranch(tree);
  for (int body = 0; body < tree.body_count(); ++body) {
    BodyShape shape{BodyLink(tree, body), OuterPoints(shapes[Size(body)]), false};
    shape.guessed = shape.points.empty();
    if (shape.guessed) shape.points = GuessPoints(tree, body, longest);
    result.bodies.push_back(std::move(shape));
  }
  return result;
}

double LongestBranch(const RobotTree& tree) {
  std::vector<double> length(Size(tree.body_count()), 0.0);
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    const Joint& joint = tree.joints[k];
    const Eigen::Vector3d offset =
        tree.links[Size(joint.parent_link)].T_body_link * joint.T_parent_child.translation();
    length[k + 1] = length[Size(joint.parent_body)] + offset.norm();
  }
  std::vector<double> ends = length;
  for (const Link& link : tree.links) {
    ends[Size(link.body)] = std::max(
        ends[Size(link.body)], length[Size(link.body)] + link.T_body_link.translation().norm());
  }
  return std::max(*std::max_element(ends.begin(), ends.end()), 1e-3);
}

std::vector<Transform> BodyPoses(const RobotTree& tree, const Eigen::VectorXd& q) {
  const std::vector<Transform> links = LinkTransforms(tree, q);
  std::vector<Transform> poses;
  for (int body = 0; body < tree.body_count(); ++body) {
    poses.push_back(links[Size(BodyLink(tree, body))]);
  }
  return poses;
}

int BodyLink(const RobotTree& tree, int body) {
  return body == 0 ? 0 : tree.joints[Size(body - 1)].child_link;
}

}  // namespace elastocal
