// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/body_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "elastocal/description/urdf_outline.hpp"
#include "elastocal/drafting/primitive.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr double kLeastDensity = 20.0;   // kg/m^3: foam
constexpr double kUsualDensity = 900.0;  // kg/m^3: mean of a robot's link with motors and hollows

/// A shape of a link, in its body's frame.
struct LinkShape {
  std::optional<Primitive> primitive;   ///< nothing for a mesh
  std::vector<Eigen::Vector3d> points;  ///< points of its surface, m
  double volume = 0.0;                  ///< m^3
};

/// Reads the shapes of a URDF's links, and collects warnings about meshes.
class ShapeReader {
 public:
  ShapeReader(const RobotTree& tree, const MeshPlaces& places)
      : places_(places), spacing_(kSpacing * LongestBranch(tree)), largest_(RobotSize(tree)) {}

  std::vector<LinkShape> Read(const XmlElement& link, const Transform& T_body_link) {
    for (const char* purpose : {"collision", "visual"}) {
      std::vector<LinkShape> shapes;
      for (const XmlElement& element : link.Children()) {
        const auto geometry =
            element.Tag() == purpose ? element.Find("geometry") : std::optional<XmlElement>();
        if (!geometry) continue;
        const UrdfOrigin origin = ReadUrdfOrigin(element);
        auto shape = ReadGeometry(*geometry, T_body_link * FromXyzRpy(origin.xyz, origin.rpy));
        if (shape) shapes.push_back(std::move(*shape));
      }
      if (!shapes.empty()) return shapes;
    }
    return {};
  }

  int meshes_read() const { return meshes_read_; }

  std::vector<std::string> Warnings() const {
    std::vector<std::string> warnings = faults_;
    for (const auto& [package, names] : missing_) {
      const std::string what = package.empty() ? "" : " of package " + Quote(package);
      const std::string help =
          package.empty() ? "" : "; give its folder by --package " + package + "=DIR";
      warnings.push_back("meshes" + what + " are missing: " + std::to_string(names.size()) +
                         ", the first one " + Quote(names.front()) + help);
    }
    return warnings;
  }

 private:
  static constexpr double kSpacing = 0.004;  // share of the longest branch: 5 mm for 1.25 m
  static constexpr std::size_t kMostPoints = 20000;

  std::optional<LinkShape> ReadGeometry(const XmlElement& geometry, const Transform& T_body_shape) {
    if (const auto mesh = geometry.Find("mesh")) return ReadTriangles(*mesh, T_body_shape);
    Primitive shape;
    shape.T_body_shape = T_body_shape;
    if (const auto box = geometry.Find("box")) {
      shape.half = 0.5 * box->Vector("size");
    } else if (const auto cylinder = geometry.Find("cylinder")) {
      shape.kind = Primitive::Kind::kCylinder;
      const double radius = cylinder->Number("radius");
      shape.half = {radius, radius, 0.5 * cylinder->Number("length")};
    } else if (const auto sphere = geometry.Find("sphere")) {
      shape.kind = Primitive::Kind::kSphere;
      shape.half.setConstant(sphere->Number("radius"));
    } else {
      return std::nullopt;
    }
    return LinkShape{shape, SurfacePoints(shape), shape.Volume()};
  }

  std::optional<LinkShape> ReadTriangles(const XmlElement& mesh, const Transform& T_body_shape) {
    const std::string name = mesh.Text("filename");
    const Eigen::Vector3d scale =
        mesh.Has("scale") ? mesh.Vector("scale") : Eigen::Vector3d(1.0, 1.0, 1.0);
    const auto file = FindMesh(name, places_);
    if (!file) {
      std::vector<std::string>& names = missing_[PackageOf(name)];
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
      return std::nullopt;
    }
    std::string reason;
    std::vector<Triangle> triangles = ReadMesh(*file, reason);
    double extent = 0.0;
    for (Triangle& triangle : triangles) {
      for (Eigen::Vector3d& p : triangle) {
        p = p.cwiseProduct(scale);
        extent = std::max(extent, p.norm());
        p = T_body_shape * p;
      }
    }
    if (extent > largest_) {
      reason = "it reaches " + FormatNumber(std::round(10.0 * extent) / 10.0) +
               " m from its origin, further than the robot; is its unit the metre?";
    }
    if (!reason.empty()) {
      faults_.push_back("mesh " + Quote(name) + " is left out: " + reason);
      return std::nullopt;
    }
    ++meshes_read_;
    return LinkShape{std::nullopt, ThinOut(SurfacePoints(triangles, spacing_), kMostPoints),
                     VolumeOf(triangles)};
  }

  const MeshPlaces& places_;
  double spacing_, largest_;
  int meshes_read_ = 0;
  std::map<std::string, std::vector<std::string>> missing_;  ///< names of meshes by their package
  std::vector<std::string> faults_;
};

/// The points of shapes, by shape, that are not inside one of the primitives.
std::vector<std::vector<Eigen::Vector3d>> OuterPoints(const std::vector<LinkShape>& shapes) {
  constexpr double kDepth = 1e-6;
  std::vector<std::vector<Eigen::Vector3d>> parts;
  for (const LinkShape& shape : shapes) {
    std::vector<Eigen::Vector3d> points;
    for (const Eigen::Vector3d& point : shape.points) {
      const bool hidden = std::any_of(shapes.begin(), shapes.end(), [&](const LinkShape& other) {
        return &other != &shape && other.primitive && other.primitive->Contains(point, kDepth);
      });
      if (!hidden) points.push_back(point);
    }
    if (!points.empty()) parts.push_back(std::move(points));
  }
  return parts;
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

/// Points of rods from the body's origin to the joints that it carries or, at the end of a limb,
/// through its centre of mass and as far beyond it. Their volume follows from the mass.
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
                           const std::string& source, const MeshPlaces& places) {
  const XmlText xml(text, source);
  const UrdfOutline outline = ReadUrdfOutline(xml);
  std::vector<std::vector<LinkShape>> shapes(Size(tree.body_count()));
  RobotShapes result;
  ShapeReader reader(tree, places);
  for (const UrdfLink& described : outline.links) {
    const auto link =
        std::find_if(tree.links.begin(), tree.links.end(),
                     [&](const Link& candidate) { return candidate.name == described.name; });
    if (link == tree.links.end()) continue;
    for (LinkShape& shape : reader.Read(described.element, link->T_body_link)) {
      if (link->mass > 0.0 && link->mass < kLeastDensity * shape.volume) {
        result.warnings.push_back("link " + Quote(link->name) + ": a shape of " +
                                  FormatNumber(std::round(1e3 * shape.volume)) +
                                  " litres is left out, the link has only " +
                                  FormatNumber(link->mass) + " kg");
        continue;
      }
      shapes[Size(link->body)].push_back(std::move(shape));
    }
  }
  result.meshes = reader.meshes_read();
  for (std::string& warning : reader.Warnings()) result.warnings.push_back(std::move(warning));
  const double longest = LongestBranch(tree);
  for (int body = 0; body < tree.body_count(); ++body) {
    BodyShape shape{BodyLink(tree, body), {}, false, OuterPoints(shapes[Size(body)])};
    for (const std::vector<Eigen::Vector3d>& part : shape.parts) {
      shape.points.insert(shape.points.end(), part.begin(), part.end());
    }
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
