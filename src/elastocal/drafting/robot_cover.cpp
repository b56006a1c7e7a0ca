// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "elastocal/drafting/spheres.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

/// Covers bodies by spheres that are symmetric where the shapes are.
class SymmetricCover {
 public:
  SymmetricCover(const RobotTree& tree, const RobotShapes& shapes, const Limbs& limbs)
      : tree_(tree),
        shapes_(shapes),
        poses_(BodyPoses(tree, Eigen::VectorXd::Zero(tree.coordinate_count()))),
        tolerance_(kTolerance * LongestBranch(tree)),
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
        cover = CoverOfMiddle(body);
      } else if (image < body && Symmetric(image, body)) {
        for (CollisionSphere sphere : covers_[Size(image)]) {
          sphere.p_link_centre = Image(image, body, sphere.p_link_centre);
          cover.push_back(sphere);
        }
      } else {
        cover = CoverPoints(shapes_.bodies[Size(body)].points, tolerance_, kMost);
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
  static constexpr double kTolerance = 0.012;  // of the longest branch: 15 mm on 1.75 m
  static constexpr int kMost = 6;

  Eigen::Vector3d Image(int from, int to, const Eigen::Vector3d& p) const {
    Eigen::Vector3d at = poses_[Size(from)] * p;
    at.y() = -at.y();
    return poses_[Size(to)].inverse() * at;
  }

  bool Symmetric(int from, int to) const {
    constexpr std::size_t kEnough = 1200;
    const std::vector<Eigen::Vector3d>& others = shapes_.bodies[Size(to)].points;
    for (const Eigen::Vector3d& p : ThinOut(shapes_.bodies[Size(from)].points, kEnough)) {
      double nearest = std::numeric_limits<double>::infinity();
      const Eigen::Vector3d image = Image(from, to, p);
      for (const Eigen::Vector3d& other : others) {
        nearest = std::min(nearest, (other - image).norm());
      }
      if (nearest > 2.0 * tolerance_) return false;
    }
    return true;
  }

  /// Of a body in the middle: one sphere in the plane of symmetry, or those of one half, reflected.
  std::vector<CollisionSphere> CoverOfMiddle(int body) const {
    const std::vector<Eigen::Vector3d>& points = shapes_.bodies[Size(body)].points;
    std::vector<CollisionSphere> whole = CoverPoints(points, tolerance_, kMost);
    if (!Symmetric(body, body)) return whole;
    std::vector<Eigen::Vector3d> half;
    for (const Eigen::Vector3d& p : points) {
      if ((poses_[Size(body)] * p).y() >= -1e-6) half.push_back(p);
    }
    if (whole.size() > 1) whole = CoverPoints(half, tolerance_, kMost / 2);
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

  const RobotTree& tree_;
  const RobotShapes& shapes_;
  std::vector<Transform> poses_;
  double tolerance_;
  std::vector<int> image_;  ///< the body on the other side
  std::vector<std::vector<CollisionSphere>> covers_;
};

/// The shapes with those of fingers added to the hands.
RobotShapes WithFingers(const RobotTree& tree, const RobotShapes& shapes, const Limbs& limbs,
                        const Eigen::VectorXd& rest) {
  RobotShapes joined = shapes;
  const std::vector<Transform> poses = BodyPoses(tree, rest);
  for (int body = 1; body < tree.body_count(); ++body) {
    if (!limbs.tool[Size(body)]) continue;
    int hand = body;
    while (limbs.tool[Size(hand)]) hand = tree.joints[Size(hand - 1)].parent_body;
    const Transform T_hand_body = poses[Size(hand)].inverse() * poses[Size(body)];
    for (const Eigen::Vector3d& p : shapes.bodies[Size(body)].points) {
      joined.bodies[Size(hand)].points.push_back(T_hand_body * p);
    }
    joined.bodies[Size(body)].points.clear();
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

}  // namespace elastocal
