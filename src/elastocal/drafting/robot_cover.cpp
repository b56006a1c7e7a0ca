// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "elastocal/drafting/spheres.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

constexpr double kCoverTolerance = 0.012;  // share of the longest branch: 15 mm for 1.25 m

/// Covers bodies by spheres, symmetrically where the shapes are symmetric.
class SymmetricCover {
 public:
  SymmetricCover(const RobotTree& tree, const RobotShapes& shapes, const Limbs& limbs)
      : tree_(tree),
        shapes_(shapes),
        poses_(BodyPoses(tree, Eigen::VectorXd::Zero(tree.coordinate_count()))),
        tolerance_(kCoverTolerance * LongestBranch(tree)),
        image_(Size(tree.body_count())),
        covers_(Size(tree.body_count())) {
    for (int b = 0; b < tree.body_count(); ++b) image_[Size(b)] = b;
    for (const Limb& limb : limbs.limbs) {
      if (limb.mirror < 0) continue;
      const Limb& other = limbs.limbs[Size(limb.mirror)];
      for (std::size_t i = 0; i < std::min(limb.joints.size(), other.joints.size()); ++i) {
        image_[Size(limb.joints[i]) + 1] = other.joints[i] + 1;
      }
    }
  }

  std::vector<CollisionSphere> Cover() {
    std::vector<CollisionSphere> spheres;
    for (int body = 0; body < tree_.body_count(); ++body) {
      std::vector<CollisionSphere>& cover = covers_[Size(body)];
      const int image = image_[Size(body)];
      if (image == body) {
        const bool symmetric = Symmetric(body, body);
        const std::vector<Eigen::Vector3d>& points = shapes_.bodies[Size(body)].points;
        cover =
            symmetric ? CoverOfMiddle(body, points, kMost) : CoverPoints(points, tolerance_, kMost);
        cover = ShapeByShape(body, symmetric, std::move(cover));
      } else if (image < body && Symmetric(image, body)) {
        for (CollisionSphere sphere : covers_[Size(image)]) {
          sphere.p_link_centre = Image(image, body, sphere.p_link_centre);
          cover.push_back(sphere);
        }
      } else {
        cover = CoverPoints(shapes_.bodies[Size(body)].points, tolerance_, kMost);
        cover = ShapeByShape(body, false, std::move(cover));
      }
      for (std::size_t i = 0; i < cover.size(); ++i) {
        CollisionSphere sphere = cover[i];
        sphere.link = shapes_.bodies[Size(body)].link;
        sphere.name = tree_.links[Size(sphere.link)].name;
        if (cover.size() > 1) sphere.name += "_" + std::to_string(i + 1);
        Eigen::Vector3d& centre = sphere.p_link_centre;
        centre = kMetresPerMm * (centre / kMetresPerMm).array().round().matrix();
        spheres.push_back(sphere);
      }
    }
    return spheres;
  }

 private:
  static constexpr int kMost = 6;

  Eigen::Vector3d Image(int from, int to, const Eigen::Vector3d& p) const {
    Eigen::Vector3d at = poses_[Size(from)] * p;
    at.y() = -at.y();
    return poses_[Size(to)].inverse() * at;
  }

  bool Symmetric(int from, int to) const {
    return AreImages(from, shapes_.bodies[Size(from)].points, to, shapes_.bodies[Size(to)].points);
  }

  bool AreImages(int from, const std::vector<Eigen::Vector3d>& points, int to,
                 const std::vector<Eigen::Vector3d>& others) const {
    constexpr std::size_t kEnough = 1200;
    for (const Eigen::Vector3d& p : ThinOut(points, kEnough)) {
      double nearest = std::numeric_limits<double>::infinity();
      const Eigen::Vector3d image = Image(from, to, p);
      for (const Eigen::Vector3d& other : others) {
        nearest = std::min(nearest, (other - image).norm());
      }
      if (nearest > 2.0 * tolerance_) return false;
    }
    return true;
  }

  /// Covers symmetric points in the middle: by one sphere in the plane of symmetry, or by spheres
  /// of one half and their reflections.
  std::vector<CollisionSphere> CoverOfMiddle(int body, const std::vector<Eigen::Vector3d>& points,
                                             int most) const {
    std::vector<CollisionSphere> whole = CoverPoints(points, tolerance_, most);
    std::vector<Eigen::Vector3d> half;
    for (const Eigen::Vector3d& p : points) {
      if ((poses_[Size(body)] * p).y() >= -1e-6) half.push_back(p);
    }
    if (whole.size() > 1) whole = CoverPoints(half, tolerance_, std::max(1, most / 2));
    std::vector<CollisionSphere> cover;
    for (CollisionSphere& sphere : whole) {
      const Eigen::Vector3d image = Image(body, body, sphere.p_link_centre);
      const double apart = 0.5 * (image - sphere.p_link_centre).norm();
      if (whole.size() == 1 || apart < tolerance_) {
        sphere.p_link_centre = 0.5 * (sphere.p_link_centre + image);
        sphere.radius += std::ceil(apart / kMetresPerMm) * kMetresPerMm;
        cover.push_back(sphere);
        continue;
      }
      cover.push_back(sphere);
      cover.push_back(sphere);
      cover.back().p_link_centre = image;
    }
    return cover;
  }

  /// Spheres of points near the plane of symmetry, moved into the plane.
  std::vector<CollisionSphere> CoverInPlane(int body, const std::vector<Eigen::Vector3d>& points,
                                            int most) const {
    std::vector<CollisionSphere> cover = CoverPoints(points, tolerance_, most);
    for (CollisionSphere& sphere : cover) {
      const Eigen::Vector3d image = Image(body, body, sphere.p_link_centre);
      const double apart = 0.5 * (image - sphere.p_link_centre).norm();
      sphere.p_link_centre = 0.5 * (sphere.p_link_centre + image);
      sphere.radius += std::ceil(apart / kMetresPerMm) * kMetresPerMm;
    }
    return cover;
  }

  /// Spheres of one shape of a body. For a symmetric body they include those of the shape's mirror
  /// image, and are empty if the shape is itself such an image.
  std::vector<CollisionSphere> CoverPart(int body, const std::vector<Eigen::Vector3d>& part,
                                         bool symmetric, int most) const {
    if (!symmetric) return CoverPoints(part, tolerance_, most);
    if (AreImages(body, part, body, part)) {
      std::vector<CollisionSphere> halves = CoverOfMiddle(body, part, most);
      std::vector<CollisionSphere> in_plane = CoverInPlane(body, part, most);
      return Volume(in_plane) < Volume(halves) ? in_plane : halves;
    }
    double y = 0.0;
    for (const Eigen::Vector3d& p : part) y += (poses_[Size(body)] * p).y();
    if (y < 0.0) return {};
    std::vector<CollisionSphere> cover = CoverPoints(part, tolerance_, most);
    for (std::size_t i = cover.size(); i-- > 0;) {
      cover.push_back(cover[i]);
      cover.back().p_link_centre = Image(body, body, cover[i].p_link_centre);
    }
    return cover;
  }

  /// The cover of a body shape by shape, if it is much thinner than the cover of all shapes
  /// together and as complete; otherwise the latter.
  std::vector<CollisionSphere> ShapeByShape(int body, bool symmetric,
                                            std::vector<CollisionSphere>&& whole) const {
    constexpr std::size_t kMostOfParts = 12, kMostParts = 24;
    constexpr double kThinner = 1.5, kSmaller = 0.7;
    const BodyShape& shape = shapes_.bodies[Size(body)];
    if (shape.parts.size() < 2 || shape.parts.size() > kMostParts) return std::move(whole);
    std::vector<const std::vector<Eigen::Vector3d>*> parts;  // the largest part first
    for (const auto& part : shape.parts) parts.push_back(&part);
    std::ranges::stable_sort(parts, std::greater(),
                             [&](const auto* part) { return FittingRadius(*part, tolerance_); });
    for (int most = kMost; most > 0; --most) {
      std::vector<CollisionSphere> cover;
      for (const std::vector<Eigen::Vector3d>* part : parts) {
        if (Covers(cover, *part)) continue;
        for (const CollisionSphere& sphere : CoverPart(body, *part, symmetric, most)) {
          cover.push_back(sphere);
        }
      }
      cover = WithoutHidden(cover);
      if (cover.size() > kMostOfParts) continue;
      const bool thinner =
          Thickest(whole) > kThinner * Thickest(cover) && Volume(cover) < kSmaller * Volume(whole);
      if (thinner && Covers(cover, shape.points)) return cover;
      break;
    }
    return std::move(whole);
  }

  /// Removes spheres that are inside others.
  std::vector<CollisionSphere> WithoutHidden(const std::vector<CollisionSphere>& spheres) const {
    std::vector<CollisionSphere> seen;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      bool hidden = false;
      for (std::size_t k = 0; k < spheres.size() && !hidden; ++k) {
        const double apart = (spheres[i].p_link_centre - spheres[k].p_link_centre).norm();
        const double inside = spheres[k].radius - apart - spheres[i].radius;
        hidden = k != i && (inside > 0.0 || (inside == 0.0 && k < i));
      }
      if (!hidden) seen.push_back(spheres[i]);
    }
    return seen;
  }

  bool Covers(const std::vector<CollisionSphere>& spheres,
              const std::vector<Eigen::Vector3d>& points) const {
    return std::ranges::all_of(points, [&](const Eigen::Vector3d& p) {
      return std::ranges::any_of(spheres, [&](const CollisionSphere& sphere) {
        return (p - sphere.p_link_centre).norm() < sphere.radius + tolerance_;
      });
    });
  }

  /// Total volume times 3 / (4 pi).
  static double Volume(const std::vector<CollisionSphere>& spheres) {
    double sum = 0.0;
    for (const CollisionSphere& sphere : spheres) sum += std::pow(sphere.radius, 3);
    return sum;
  }

  static double Thickest(const std::vector<CollisionSphere>& spheres) {
    double radius = 0.0;
    for (const CollisionSphere& sphere : spheres) radius = std::max(radius, sphere.radius);
    return radius;
  }

  const RobotTree& tree_;
  const RobotShapes& shapes_;
  std::vector<Transform> poses_;
  double tolerance_;
  std::vector<int> image_;  ///< index of the mirrored body
  std::vector<std::vector<CollisionSphere>> covers_;
};

/// The shapes, with those of fingers added to the hands.
RobotShapes WithFingers(const RobotTree& tree, const RobotShapes& shapes, const Limbs& limbs,
                        const Eigen::VectorXd& rest) {
  RobotShapes joined = shapes;
  const std::vector<Transform> poses = BodyPoses(tree, rest);
  for (int body = 1; body < tree.body_count(); ++body) {
    if (!limbs.tool[Size(body)]) continue;
    int hand = body;
    while (limbs.tool[Size(hand)]) hand = tree.joints[Size(hand - 1)].parent_body;
    const Transform T_hand_body = poses[Size(hand)].inverse() * poses[Size(body)];
    std::vector<Eigen::Vector3d> part;
    for (const Eigen::Vector3d& p : shapes.bodies[Size(body)].points) {
      part.emplace_back(T_hand_body * p);
    }
    BodyShape& of_hand = joined.bodies[Size(hand)];
    of_hand.points.insert(of_hand.points.end(), part.begin(), part.end());
    if (!of_hand.parts.empty() && !part.empty()) of_hand.parts.push_back(std::move(part));
    joined.bodies[Size(body)].points.clear();
    joined.bodies[Size(body)].parts.clear();
  }
  constexpr std::size_t kMost = 20000;
  for (BodyShape& body : joined.bodies) body.points = ThinOut(body.points, kMost);
  return joined;
}

}  // namespace

std::vector<CollisionSphere> CoverRobot(const RobotTree& tree, const RobotShapes& shapes,
                                        const Limbs& limbs, const Eigen::VectorXd& rest) {
  const RobotShapes joined = WithFingers(tree, shapes, limbs, rest);
  std::vector<CollisionSphere> spheres = SymmetricCover(tree, joined, limbs).Cover();
  std::set<std::string> names;
  for (CollisionSphere& sphere : spheres) {
    while (!names.insert(sphere.name).second) sphere.name += "_";
  }
  return spheres;
}

std::vector<std::string> CoarseCovers(const RobotTree& tree, const RobotShapes& shapes,
                                      const std::vector<CollisionSphere>& spheres) {
  constexpr double kCoarse = 2.0;
  const double tolerance = kCoverTolerance * LongestBranch(tree);
  std::vector<std::string> sentences;
  for (int body = 0; body < tree.body_count(); ++body) {
    const BodyShape& shape = shapes.bodies[Size(body)];
    if (shape.parts.empty()) continue;
    double fits = 0.0, radius = 0.0;
    for (const auto& part : shape.parts) fits = std::max(fits, FittingRadius(part, tolerance));
    for (const CollisionSphere& sphere : spheres) {
      if (sphere.link == shape.link) radius = std::max(radius, sphere.radius);
    }
    if (radius <= kCoarse * fits) continue;
    sentences.push_back(fmt::format(
        "the spheres that cover '{}' are coarse: one has a radius of {:.0f} mm, where {:.0f} mm "
        "would fit its shapes; more and smaller ones in collision.spheres let limbs come nearer",
        tree.links[Size(shape.link)].name, radius / kMetresPerMm, fits / kMetresPerMm));
  }
  return sentences;
}

}  // namespace elastocal
