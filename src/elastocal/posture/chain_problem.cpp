// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/chain_problem.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/priority_qr.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/math/rrt_connect.hpp"
#include "elastocal/posture/clearance.hpp"
#include "elastocal/posture/dexterity.hpp"
#include "elastocal/posture/torque_limit.hpp"
#include "elastocal/posture/workspace.hpp"

namespace elastocal {
namespace {

/// Coordinates of all joints from the root to a link.
std::vector<int> PathCoordinates(const RobotTree& tree, int link) {
  return ChainCoordinates(tree, 0, link);
}

/// Spheres on links that the chain moves, except on legs that stand. A standing leg that shares a
/// joint with the chain keeps its foot on the floor by its own joints.
std::vector<CollisionSphere> MovedSpheres(const RobotTree& tree, const MotionSetup& motion,
                                          const ChainSetup& chain) {
  const std::vector<int> own = JointsToBody(tree, tree.links[chain.tip_link].body);
  const auto is_moved = [&](const CollisionSphere& sphere) {
    const std::vector<int> path = JointsToBody(tree, tree.links[sphere.link].body);
    return std::any_of(path.begin(), path.end(),
                       [&](int joint) { return IsMovedBy(tree.joints[joint], chain.coordinates); });
  };
  const auto stands = [&](const CollisionSphere& sphere) {
    const std::vector<int> path = JointsToBody(tree, tree.links[sphere.link].body);
    return std::any_of(chain.support.begin(), chain.support.end(), [&](int sole) {
      const std::vector<int> leg = JointsToBody(tree, tree.links[sole].body);
      return std::any_of(leg.begin(), leg.end(), [&](int joint) {
        return std::find(own.begin(), own.end(), joint) == own.end() &&
               std::find(path.begin(), path.end(), joint) != path.end();
      });
    });
  };
  std::vector<CollisionSphere> moved;
  for (const CollisionSphere& sphere : motion.spheres) {
    if (is_moved(sphere) && !stands(sphere)) moved.push_back(sphere);
  }
  return moved;
}

/// Whether the line from a to b intersects the sphere.
bool Hides(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& centre,
           double radius) {
  const Eigen::Vector3d line = b - a;
  const double along = std::clamp(line.dot(centre - a) / line.squaredNorm(), 0.0, 1.0);
  return (a + along * line - centre).norm() < radius;
}

MarkerVisibility MakeVisibility(const ErrorModel& model, const MotionSetup& motion) {
  if (motion.cameras.empty() || motion.spheres.empty()) return {};
  return [&model, &motion](const MovingChain& chain) {
    const Eigen::Matrix3Xd centres = SphereCentres(motion.spheres, chain.link_poses());
    std::vector<char> visible;
    for (const Marker& marker : model.markers) {
      const Eigen::Vector3d p = chain.link_poses()[marker.link] * marker.p_link_marker;
      const auto seen_by = [&](const Eigen::Vector3d& camera) {
        for (std::size_t s = 0; s < motion.spheres.size(); ++s) {
          const CollisionSphere& sphere = motion.spheres[s];
          // A marker is on its link's surface, which the link's spheres only approximate.
          if (model.tree.links[sphere.link].body == model.tree.links[marker.link].body) continue;
          if (Hides(p, camera, centres.col(static_cast<Eigen::Index>(s)), sphere.radius)) {
            return false;
          }
        }
        return true;
      };
      visible.push_back(std::any_of(motion.cameras.begin(), motion.cameras.end(), seen_by) ? 1 : 0);
    }
    return visible;
  };
}

/// Makes a function that says whether a chain can move from rest to a posture past the robot's own
/// parts. Empty if nothing can touch, or if parts touch at rest already.
std::function<bool(const Eigen::VectorXd&)> MakeReachability(const RobotTree& tree,
                                                             const MotionSetup& motion,
                                                             const ChainSetup& chain) {
  const auto free = [moving = std::make_shared<MovingChain>(tree, chain.coordinates, motion.rest),
                     spheres = motion.spheres, pairs = chain.contacts,
                     margin = motion.sphere_margin](const Eigen::VectorXd& x) {
    InterruptionPoint();
    moving->Move(x);
    return SphereDistances(spheres, pairs, moving->link_poses()).minCoeff() >= margin;
  };
  const Eigen::VectorXd rest = motion.rest(chain.coordinates);
  if (chain.contacts.empty() || !free(rest)) return {};
  FreeSpace space;
  space.lower = motion.lower(chain.coordinates);
  space.upper = motion.upper(chain.coordinates);
  space.free = free;
  return [reachable = std::make_shared<ReachableSpace>(std::move(space), rest)](
             const Eigen::VectorXd& x) { return reachable->Reaches(x); };
}

RootPose RootOf(const MotionSetup& motion) {
  return motion.free_root ? RootPose::kFree : RootPose::kConstant;
}

/// Keeps only the compliances that gravity excites in these postures (rows of q) and whose effect
/// differs from that of the other parameters.
void KeepExcited(const ErrorModel& model, const MotionSetup& motion, const ChainSetup& chain,
                 const Eigen::MatrixXd& q, BaseParameters& base) {
  constexpr Eigen::Index kPostures = 100;
  constexpr double kTolerance = 1e-3;  // least part of a column that is independent of the others
  std::vector<int> order;              // geometry has priority
  for (int elastic : {0, 1}) {
    for (std::size_t i = 0; i < base.kept.size(); ++i) {
      if (IsElastic(model.parameters[base.kept[i]].kind) == (elastic != 0)) {
        order.push_back(static_cast<int>(i));
      }
    }
  }
  const auto geometric = static_cast<std::size_t>(base.geometric_count);
  if (order.size() == geometric) return;
  MovingChain moving(model.tree, chain.coordinates, motion.rest);
  PostureRegressor regressor(model, base.kept, moving, RootOf(motion));
  const Eigen::Index postures = std::min(kPostures, q.rows());
  Eigen::MatrixXd stacked(postures * regressor.rows(), regressor.columns());
  for (Eigen::Index i = 0; i < postures; ++i) {
    const Eigen::VectorXd x = q.row(i).transpose()(chain.coordinates);
    stacked.middleRows(i * regressor.rows(), regressor.rows()) = regressor.Evaluate(moving, x);
  }
  const PriorityQrResult excited = PriorityQr(stacked(Eigen::all, order), kTolerance);
  std::vector<int> rows;
  for (int i : excited.kept) rows.push_back(order[i]);
  std::sort(rows.begin(), rows.end());
  std::vector<int> kept;
  base.geometric_count = 0;
  for (int i : rows) {
    kept.push_back(base.kept[i]);
    if (!IsElastic(model.parameters[kept.back()].kind)) ++base.geometric_count;
  }
  base.regrouping = Eigen::MatrixXd(base.regrouping(rows, Eigen::all));
  base.kept = std::move(kept);
}

/// The sphere that is the mirror image of another at zero posture, or -1.
int FindMirrorSphere(const std::vector<CollisionSphere>& spheres, const Eigen::Matrix3Xd& centres,
                     int sphere) {
  constexpr double kNear = 5e-3;  // m
  const Eigen::Vector3d wanted =
      Eigen::Vector3d(1.0, -1.0, 1.0).cwiseProduct(Eigen::Vector3d(centres.col(sphere)));
  for (std::size_t s = 0; s < spheres.size(); ++s) {
    if ((centres.col(static_cast<Eigen::Index>(s)) - wanted).norm() < kNear &&
        std::abs(spheres[s].radius - spheres[sphere].radius) < kNear) {
      return static_cast<int>(s);
    }
  }
  return -1;
}

}  // namespace

FeasibleSet MakeFeasibleSet(const RobotTree& tree, const MotionSetup& motion,
                            const ChainSetup& chain) {
  FeasibleSet set{MovingChain(tree, chain.coordinates, motion.rest),
                  motion.lower(chain.coordinates),
                  motion.upper(chain.coordinates),
                  {},
                  chain.tip_link};
  set.workspace.R_root_end = LinkTransforms(tree, motion.rest)[chain.tip_link].linear();
  set.workspace.largest_turn = chain.largest_turn;
  if (chain.box) {
    set.has_workspace = true;
    set.workspace.lower = chain.box->lower;
    set.workspace.upper = chain.box->upper;
    set.constraints.push_back(std::make_unique<EndBox>(chain.tip_link, set.workspace));
  }
  if (chain.largest_turn < M_PI) {
    set.constraints.push_back(std::make_unique<OrientationCone>(chain.tip_link, set.workspace));
  }
  set.constraints.push_back(std::make_unique<TorqueLimit>(
      tree, PathCoordinates(tree, chain.tip_link), motion.effort_share));
  if (chain.dexterity_share > 0.0 && set.chain.size() >= 6) {
    set.constraints.push_back(
        std::make_unique<Dexterity>(set.chain, chain.tip_link, chain.dexterity_share));
  }
  if (!chain.contacts.empty()) {
    set.constraints.push_back(
        std::make_unique<SphereClearance>(motion.spheres, chain.contacts, motion.sphere_margin));
    set.reachable = MakeReachability(tree, motion, chain);
  }
  if (chain.floor_z) {
    set.constraints.push_back(
        std::make_unique<FloorClearance>(MovedSpheres(tree, motion, chain), *chain.floor_z));
  }
  return set;
}

BaseParameters FindChainParameters(const ErrorModel& model, const MotionSetup& motion,
                                   const ChainSetup& chain, IdentifiabilityOptions options) {
  for (const Parameter& parameter : model.parameters) {
    // Errors of rods are held, because their effect has no derivative by the posture here.
    if (parameter.linkage >= 0) options.hold.push_back(parameter.name);
    if (parameter.joint < 0) continue;
    if (!IsMovedBy(model.tree.joints[parameter.joint], chain.coordinates)) {
      options.hold.push_back(parameter.name);
    }
  }
  Random random(options.seed);
  Eigen::MatrixXd q(options.postures, model.tree.coordinate_count());
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    q.row(i) = motion.rest.transpose();
    for (int c : chain.coordinates) q(i, c) = random.Uniform(motion.lower[c], motion.upper[c]);
  }
  options.root = RootOf(motion);
  BaseParameters base = FindBaseParameters(model, NominalFactor(model, q, options.root), options);
  KeepExcited(model, motion, chain, q, base);
  return base;
}

PostureProblem MakeChainProblem(const ErrorModel& model, const std::vector<int>& base,
                                const MotionSetup& motion, const ChainSetup& chain,
                                Criterion criterion) {
  FeasibleSet feasible = MakeFeasibleSet(model.tree, motion, chain);
  PostureRegressor regressor(model, base, feasible.chain, RootOf(motion));
  return {std::move(feasible), std::move(regressor), criterion, MakeVisibility(model, motion)};
}

std::optional<ChainSetup> MirrorSetup(const RobotTree& tree, const MotionSetup& motion,
                                      const ChainSetup& chain, const std::string& other_name,
                                      int other_from, int other_tip, std::string* reason) {
  const Eigen::Matrix3Xd centres = SphereCentres(
      motion.spheres, LinkTransforms(tree, Eigen::VectorXd::Zero(tree.coordinate_count())));
  ChainSetup other = chain;
  other.name = other_name;
  other.mirror = chain.name;
  other.from_link = other_from;
  other.tip_link = other_tip;
  other.coordinates = ChainCoordinates(tree, other_from, other_tip);
  if (chain.box) {
    other.box->lower.y() = -chain.box->upper.y();
    other.box->upper.y() = -chain.box->lower.y();
  }
  for (SpherePair& pair : other.contacts) {
    for (int* sphere : {&pair.first, &pair.second}) {
      const int image = FindMirrorSphere(motion.spheres, centres, *sphere);
      if (image < 0) {
        *reason = "sphere " + motion.spheres[*sphere].name + " has no mirror image";
        return std::nullopt;
      }
      *sphere = image;
    }
  }
  // A support foot is exchanged for the one on the other side.
  for (int& foot : other.support) {
    if (foot == other_tip) foot = chain.tip_link;
  }
  return other;
}

}  // namespace elastocal
