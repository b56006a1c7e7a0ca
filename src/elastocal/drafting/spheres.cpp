// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/spheres.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>

#include <Eigen/Eigenvalues>

#include "elastocal/drafting/rest_posture.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

using Points3 = std::vector<Eigen::Vector3d>;

/// Centre of a ball around the points that is hardly larger than the smallest one (Badoiu and
/// Clarkson: steps towards the furthest point).
Eigen::Vector3d BallCentre(const Points3& points) {
  constexpr int kSteps = 100;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) centre += p / static_cast<double>(points.size());
  for (int i = 0; i < kSteps; ++i) {
    const auto furthest = std::max_element(
        points.begin(), points.end(), [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
          return (a - centre).squaredNorm() < (b - centre).squaredNorm();
        });
    centre += (*furthest - centre) / (i + 2.0);
  }
  return centre;
}

/// Half of the extents along the principal axes, the largest last.
Eigen::Vector3d HalfExtents(const Points3& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) covariance += (p - mean) * (p - mean).transpose();
  const Eigen::Matrix3d axes =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors();
  Eigen::Vector3d least = Eigen::Vector3d::Constant(1e9), most = -least;
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3d local = axes.transpose() * (p - mean);
    least = least.cwiseMin(local);
    most = most.cwiseMax(local);
  }
  Eigen::Vector3d half = 0.5 * (most - least);
  std::sort(half.data(), half.data() + 3);
  return half;
}

std::size_t Nearest(const std::vector<Eigen::Vector3d>& centres, const Eigen::Vector3d& p) {
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < centres.size(); ++i) {
    if ((centres[i] - p).squaredNorm() < (centres[nearest] - p).squaredNorm() - 1e-15) nearest = i;
  }
  return nearest;
}

/// Balls around groups of points. Each point belongs to the nearest centre; centres and groups are
/// updated in turn.
std::vector<CollisionSphere> Balls(const Points3& all, int count) {
  constexpr int kRounds = 12;
  // Points that determine the centres; the radii enclose all points.
  constexpr std::size_t kEnough = 1200;
  const Points3 points = ThinOut(all, kEnough);
  std::vector<Eigen::Vector3d> centres = {BallCentre(points)};
  if (count > 1) centres.clear();
  Eigen::Vector3d next = points.front();
  while (static_cast<int>(centres.size()) < count) {  // new centres are far from the others
    double furthest = -1.0;
    for (const Eigen::Vector3d& p : points) {
      double d =
          centres.empty() ? (p - points.front()).norm() : (p - centres[Nearest(centres, p)]).norm();
      if (d > furthest + 1e-9) {
        furthest = d;
        next = p;
      }
    }
    centres.push_back(next);
  }
  std::vector<Points3> groups;
  for (int round = 0; round < kRounds; ++round) {
    groups.assign(centres.size(), {});
    for (const Eigen::Vector3d& p : points) groups[Nearest(centres, p)].push_back(p);
    for (std::size_t i = 0; i < centres.size(); ++i) {
      if (!groups[i].empty()) centres[i] = BallCentre(groups[i]);
    }
  }
  if (points.size() < all.size()) {
    groups.assign(centres.size(), {});
    for (const Eigen::Vector3d& p : all) groups[Nearest(centres, p)].push_back(p);
  }
  std::vector<CollisionSphere> balls;
  for (std::size_t i = 0; i < centres.size(); ++i) {
    if (groups[i].empty()) continue;
    CollisionSphere ball{"", 0, centres[i], 0.0};
    for (const Eigen::Vector3d& p : groups[i]) {
      ball.radius = std::max(ball.radius, (p - centres[i]).norm());
    }
    balls.push_back(ball);
  }
  return balls;
}

double LargestRadius(const std::vector<CollisionSphere>& balls) {
  double largest = 0.0;
  for (const CollisionSphere& ball : balls) largest = std::max(largest, ball.radius);
  return largest;
}

/// Whether the SRDF excludes links of the two bodies from collision checks.
bool LeftOutBySemantics(const RobotTree& tree, const Semantics& semantics, int a, int b) {
  return std::any_of(semantics.apart.begin(), semantics.apart.end(), [&](const auto& pair) {
    const auto body = [&](const std::string& name) {
      for (const Link& link : tree.links) {
        if (link.name == name) return link.body;
      }
      return -1;
    };
    const int one = body(pair.first), other = body(pair.second);
    return (one == a && other == b) || (one == b && other == a);
  });
}

/// Whether one body carries the other with at most one body in between, so that their shapes touch
/// by design.
bool Neighbours(const RobotTree& tree, int a, int b) {
  const auto carrier = [&](int body) {
    return body == 0 ? -1 : tree.joints[Size(body - 1)].parent_body;
  };
  if (a == b || carrier(a) == b || carrier(b) == a) return true;
  return (carrier(a) >= 0 && carrier(carrier(a)) == b) ||
         (carrier(b) >= 0 && carrier(carrier(b)) == a);
}

/// Whether all joints between two bodies are prismatic with parallel axes, as in a telescope.
bool SlideAlongEachOther(const RobotTree& tree, int one, int other) {
  const std::vector<int> to_one = JointsToBody(tree, one), to_other = JointsToBody(tree, other);
  std::vector<int> between;
  std::set_symmetric_difference(to_one.begin(), to_one.end(), to_other.begin(), to_other.end(),
                                std::back_inserter(between));
  if (std::any_of(between.begin(), between.end(), [&](int joint) {
        return tree.joints[Size(joint)].type != JointType::kPrismatic;
      })) {
    return false;
  }
  const auto poses = LinkTransforms(tree, Eigen::VectorXd::Zero(tree.coordinate_count()));
  const auto axis = [&](int joint) -> Eigen::Vector3d {
    const Joint& of = tree.joints[Size(joint)];
    return poses[Size(of.child_link)].linear() * of.axis;
  };
  return std::all_of(between.begin(), between.end(), [&](int joint) {
    return axis(joint).cross(axis(between.front())).norm() < 1e-3;
  });
}

/// Whether a position of the chain's tip is in its box enlarged by a quarter.
bool NearBox(const ChainSetup& chain, const Eigen::Vector3d& tip) {
  constexpr double kWider = 0.25;
  if (!chain.box) return true;
  const Eigen::Vector3d more = kWider * (chain.box->upper - chain.box->lower);
  return (tip.array() >= (chain.box->lower - more).array()).all() &&
         (tip.array() <= (chain.box->upper + more).array()).all();
}

}  // namespace

double FittingRadius(const Points3& points, double tolerance) {
  // Balls have the thickness of a rod, or the width of the shorter side of a plate.
  return 1.15 * HalfExtents(points)[1] + 2.0 * tolerance;
}

std::vector<CollisionSphere> CoverPoints(const Points3& points, double tolerance, int most) {
  if (points.empty()) return {};
  const double enough = FittingRadius(points, tolerance);
  std::vector<CollisionSphere> best;
  for (int count = 1; count <= most; ++count) {
    best = Balls(points, count);
    if (LargestRadius(best) <= enough) break;
  }
  for (CollisionSphere& ball : best) {
    ball.p_link_centre =
        kMetresPerMm * (ball.p_link_centre / kMetresPerMm).array().round().matrix();
    const double radius = std::max(ball.radius - 0.8 * tolerance, 0.3 * ball.radius);
    ball.radius = std::max(1.0, std::ceil(radius / kMetresPerMm)) * kMetresPerMm;
  }
  return best;
}

std::vector<SpherePair> PairsMovedBy(const RobotTree& tree,
                                     const std::vector<CollisionSphere>& spheres,
                                     const std::vector<int>& coordinates,
                                     const Semantics& semantics) {
  std::vector<bool> moved(Size(tree.body_count()), false);
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    const Joint& joint = tree.joints[k];
    const bool own =
        std::find(coordinates.begin(), coordinates.end(), joint.coordinate) != coordinates.end();
    moved[k + 1] = own || moved[Size(joint.parent_body)];
  }
  std::vector<SpherePair> pairs;
  for (std::size_t a = 0; a < spheres.size(); ++a) {
    for (std::size_t b = a + 1; b < spheres.size(); ++b) {
      const int one = tree.links[Size(spheres[a].link)].body;
      const int other = tree.links[Size(spheres[b].link)].body;
      if (!moved[Size(one)] && !moved[Size(other)]) continue;
      if (Neighbours(tree, one, other) || SlideAlongEachOther(tree, one, other)) continue;
      if (LeftOutBySemantics(tree, semantics, one, other)) continue;
      pairs.emplace_back(static_cast<int>(a), static_cast<int>(b));
    }
  }
  return pairs;
}

ContactSearch FindContacts(const RobotTree& tree, const std::vector<CollisionSphere>& spheres,
                           const std::vector<SpherePair>& candidates,
                           const std::vector<Eigen::VectorXd>& rests, const ChainSetup& chain,
                           double margin) {
  constexpr int kPostures = 1500, kDraws = 20000;
  constexpr double kNearlyAlways = 0.9;
  ContactSearch found;
  Eigen::ArrayXd at_rest = Eigen::ArrayXd::Constant(static_cast<Eigen::Index>(candidates.size()),
                                                    std::numeric_limits<double>::infinity());
  for (const Eigen::VectorXd& rest : rests) {
    at_rest = at_rest.min(SphereDistances(spheres, candidates, LinkTransforms(tree, rest)).array());
  }
  std::vector<SpherePair> apart;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const bool touches = at_rest[static_cast<Eigen::Index>(i)] < margin;
    (touches ? found.touching_at_rest : apart).push_back(candidates[i]);
  }
  const auto range = RangesOf(tree, 0.02);
  std::vector<int> touched(apart.size(), 0);
  Random random(1);
  int postures = 0;
  for (int n = 0; n < kDraws && postures < kPostures; ++n) {
    Eigen::VectorXd q = rests.front();
    for (const int c : chain.coordinates) q[c] = random.Uniform(range.first[c], range.second[c]);
    const std::vector<Transform> poses = LinkTransforms(tree, q);
    if (!NearBox(chain, poses[Size(chain.tip_link)].translation())) continue;
    ++postures;
    const Eigen::VectorXd distances = SphereDistances(spheres, apart, poses);
    for (std::size_t i = 0; i < apart.size(); ++i) {
      if (distances[static_cast<Eigen::Index>(i)] < margin) ++touched[i];
    }
  }
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < apart.size(); ++i) {
    if (touched[i] > 0 && touched[i] < kNearlyAlways * postures) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return touched[i] > touched[j]; });
  for (const std::size_t i : order) found.pairs.push_back(apart[i]);
  return found;
}

}  // namespace elastocal
