// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/clusters.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

using Triple = std::array<Eigen::Vector3d, 3>;

/// Distance of two lines, each given by a point and a direction.
double LineDistance(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& q,
                    const Eigen::Vector3d& b) {
  constexpr double kParallel = 1e-3;
  const Eigen::Vector3d normal = a.cross(b);
  if (normal.norm() < kParallel) return (q - p).cross(a).norm();
  return std::abs((q - p).dot(normal.normalized()));
}

double DistanceTo(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& other : points) nearest = std::min(nearest, (other - p).norm());
  return nearest;
}

struct Candidate {
  Eigen::Vector3d p;  ///< in the body's frame
  double free = 0.0;  ///< distance to the nearest other body in the posture of rest, m
};

/// Selects points that are far from each other, those in the open first.
std::vector<Candidate> SpreadOut(std::vector<Candidate> all, std::size_t count, double enough) {
  std::vector<Candidate> chosen;
  std::vector<double> distance(all.size(), std::numeric_limits<double>::infinity());
  while (chosen.size() < std::min(count, all.size())) {
    std::size_t best = 0;
    double most = -1.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double value = std::min(distance[i], 1.0) * std::min(all[i].free, enough);
      if (value > most + 1e-9) {
        most = value;
        best = i;
      }
    }
    if (distance[best] < 1e-4) break;
    chosen.push_back(all[best]);
    for (std::size_t i = 0; i < all.size(); ++i) {
      distance[i] = std::min(distance[i], (all[i].p - all[best].p).norm());
    }
  }
  return chosen;
}

/// Lengths of the sides, the shortest first.
std::array<double, 3> Sides(const Triple& t) {
  std::array<double, 3> sides = {(t[0] - t[1]).norm(), (t[1] - t[2]).norm(), (t[2] - t[0]).norm()};
  std::sort(sides.begin(), sides.end());
  return sides;
}

/// Score of three markers: a triangle that is not flat, large up to a limit, with clearly different
/// sides (each at most the share `alike` of the next), in the open. Negative for a triangle that
/// must not be used.
double Worth(const std::array<const Candidate*, 3>& c, double largest, double alike) {
  constexpr double kFlattest = 0.35;
  const Triple triple = {c[0]->p, c[1]->p, c[2]->p};
  const std::array<double, 3> sides = Sides(triple);
  if (sides[0] > alike * sides[1] || sides[1] > alike * sides[2]) return -1.0;
  const double height =
      (triple[1] - triple[0]).cross(triple[2] - triple[0]).norm() / std::max(sides[2], 1e-9);
  if (height < kFlattest * sides[2]) return -1.0;
  double open = std::numeric_limits<double>::infinity();
  for (const Candidate* one : c) open = std::min(open, one->free);
  const double size = std::min(sides[2], largest) - std::max(0.0, sides[2] - largest);
  return size + height + 0.5 * std::min(open, 0.3 * largest);
}

Triple Rounded(Triple triple) {
  for (Eigen::Vector3d& p : triple) p = kMetresPerMm * (p / kMetresPerMm).array().round().matrix();
  return triple;
}

std::optional<Triple> BestTriple(const std::vector<Candidate>& candidates, double largest,
                                 double alike) {
  double best = 0.0;
  std::optional<Triple> found;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    for (std::size_t j = i + 1; j < candidates.size(); ++j) {
      for (std::size_t k = j + 1; k < candidates.size(); ++k) {
        const double worth =
            Worth({&candidates[i], &candidates[j], &candidates[k]}, largest, alike);
        if (worth <= best + 1e-9) continue;
        best = worth;
        found = Triple{candidates[i].p, candidates[j].p, candidates[k].p};
      }
    }
  }
  return found;
}

class ClusterPlacer {
 public:
  ClusterPlacer(const RobotTree& tree, const RobotShapes& shapes, const Eigen::VectorXd& rest)
      : tree_(tree),
        shapes_(Thinned(shapes)),
        T_rest_(BodyPoses(tree, rest)),
        T_zero_(BodyPoses(tree, Eigen::VectorXd::Zero(tree.coordinate_count()))),
        longest_(LongestBranch(tree)) {
    floor_ = std::numeric_limits<double>::infinity();
    for (int b = 0; b < tree.body_count(); ++b) {
      for (const Eigen::Vector3d& p : shapes.bodies[Size(b)].points) {
        floor_ = std::min(floor_, (T_rest_[Size(b)] * p).z());
      }
    }
  }

  void Place(int body, int mirrored_body) {
    if (!placed_.insert(body).second) return;
    DraftedCluster cluster;
    cluster.body = body;
    cluster.guessed = shapes_.bodies[Size(body)].guessed;
    cluster.name = Name(body);
    const auto other = clusters.end() != Find(mirrored_body) ? Reflected(*Find(mirrored_body), body)
                                                             : std::nullopt;
    cluster.points = other ? *other : Choose(body);
    clusters.push_back(cluster);
  }

  std::vector<DraftedCluster> clusters;

 private:
  /// Thins the points, because each is compared with all others.
  static RobotShapes Thinned(RobotShapes shapes) {
    constexpr std::size_t kMost = 600;
    for (BodyShape& body : shapes.bodies) body.points = ThinOut(body.points, kMost);
    return shapes;
  }

  std::vector<DraftedCluster>::const_iterator Find(int body) const {
    return std::find_if(clusters.begin(), clusters.end(),
                        [&](const DraftedCluster& c) { return c.body == body; });
  }

  std::string Name(int body) {
    if (body == 0) return "BASE";
    std::string name;
    for (const char c : tree_.links[Size(BodyLink(tree_, body))].name) {
      const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0;
      name += plain ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : '_';
    }
    const std::string ending = "_LINK";
    if (name.size() > ending.size() && name.ends_with(ending)) {
      name.resize(name.size() - ending.size());
    }
    const std::string wanted = name;
    const auto taken = [&](const DraftedCluster& c) { return c.name == name; };
    for (int i = 2; name == "BASE" || std::any_of(clusters.begin(), clusters.end(), taken); ++i) {
      name = wanted + "_" + std::to_string(i);
    }
    return name;
  }

  /// The mirror image of a cluster, if it also lies on the shape of this body.
  std::optional<Triple> Reflected(const DraftedCluster& other, int body) const {
    constexpr double kOnShape = 0.02;
    Triple triple;
    for (std::size_t i = 0; i < 3; ++i) {
      Eigen::Vector3d p = T_zero_[Size(other.body)] * other.points[i];
      p.y() = -p.y();
      triple[i] = T_zero_[Size(body)].inverse() * p;
      if (DistanceTo(shapes_.bodies[Size(body)].points, triple[i]) > kOnShape * longest_) {
        return std::nullopt;
      }
    }
    return Rounded(triple);
  }

  std::vector<Candidate> CandidatesOf(int body) const {
    constexpr double kAboveFloor = 0.02;
    std::vector<Candidate> candidates;
    for (const Eigen::Vector3d& p : shapes_.bodies[Size(body)].points) {
      const Eigen::Vector3d at = T_rest_[Size(body)] * p;
      if (at.z() < floor_ + kAboveFloor * longest_ && body != 0) continue;
      Candidate candidate{p, std::numeric_limits<double>::infinity()};
      for (int b = 0; b < tree_.body_count(); ++b) {
        if (b == body) continue;
        candidate.free = std::min(candidate.free, DistanceTo(shapes_.bodies[Size(b)].points,
                                                             T_rest_[Size(b)].inverse() * at));
      }
      candidates.push_back(candidate);
    }
    return candidates;
  }

  Triple Choose(int body) const {
    constexpr std::size_t kCandidates = 40;
    constexpr double kLargest = 0.13, kLeast = 0.03;
    const double largest = kLargest * longest_, least = kLeast * longest_;
    const auto candidates = SpreadOut(CandidatesOf(body), kCandidates, 0.3 * largest);
    // Positions are measured with a ruler, to 10 mm. Labels are told apart by sides that differ by
    // more, so sides are as different as shapes allow: below 0.7, triangles become flat.
    for (const double alike : {0.75, 0.82, 0.88}) {
      const auto triple = BestTriple(candidates, largest, alike);
      if (triple && Sides(*triple)[1] >= least) return Rounded(*triple);
    }
    // A small plate on a link that is too small itself.
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : shapes_.bodies[Size(body)].points) {
      centre += p / static_cast<double>(shapes_.bodies[Size(body)].points.size());
    }
    const double s = 2.0 * least;
    return Rounded({centre + s * Eigen::Vector3d(0.6, 0.0, 0.2),
                    centre + s * Eigen::Vector3d(-0.1, 0.5, 0.4),
                    centre + s * Eigen::Vector3d(-0.5, -0.4, 0.3)});
  }

  const RobotTree& tree_;
  RobotShapes shapes_;
  std::vector<Transform> T_rest_, T_zero_;
  double longest_, floor_;
  std::set<int> placed_;
};

}  // namespace

std::vector<int> MarkedBodies(const RobotTree& tree, const RobotShapes& shapes, const Limb& limb) {
  constexpr double kMeet = 0.02, kSmall = 0.10;
  const double longest = LongestBranch(tree);
  const auto poses = BodyPoses(tree, Eigen::VectorXd::Zero(tree.coordinate_count()));
  std::vector<int> bodies;
  for (std::size_t i = 0; i + 1 < limb.joints.size(); ++i) {
    const auto line = [&](int k) { return poses[Size(k) + 1]; };
    const int k = limb.joints[i], next = limb.joints[i + 1];
    const double apart =
        LineDistance(line(k).translation(), line(k).linear() * tree.joints[Size(k)].axis,
                     line(next).translation(), line(next).linear() * tree.joints[Size(next)].axis);
    double reach = 0.0;
    for (const Eigen::Vector3d& p : shapes.bodies[Size(k) + 1].points) {
      reach = std::max(reach, p.norm());
    }
    if (apart > kMeet * longest || reach > kSmall * longest) bodies.push_back(k + 1);
  }
  bodies.push_back(limb.tip_body);
  return bodies;
}

std::vector<DraftedCluster> PlaceClusters(const RobotTree& tree, const RobotShapes& shapes,
                                          const Limbs& limbs, const Eigen::VectorXd& rest) {
  ClusterPlacer placer(tree, shapes, rest);
  placer.Place(0, -1);
  for (std::size_t i = 0; i < limbs.limbs.size(); ++i) {
    const Limb& limb = limbs.limbs[i];
    std::map<int, int> mirrored;
    if (limb.mirror >= 0) {
      const Limb& other = limbs.limbs[Size(limb.mirror)];
      for (std::size_t k = 0; k < std::min(limb.joints.size(), other.joints.size()); ++k) {
        mirrored[limb.joints[k] + 1] = other.joints[k] + 1;
      }
    }
    for (const int body : MarkedBodies(tree, shapes, limb)) {
      const auto other = mirrored.find(body);
      placer.Place(body, other == mirrored.end() ? -1 : other->second);
    }
  }
  return placer.clusters;
}

}  // namespace elastocal
