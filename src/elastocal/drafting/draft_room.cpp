// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/draft_room.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "elastocal/drafting/correction_room.hpp"
#include "elastocal/drafting/standing_draft.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

double DegreesDown(double angle) {
  return kRadiansPerDegree * std::floor(angle / kRadiansPerDegree);
}
double DegreesUp(double angle) { return kRadiansPerDegree * std::ceil(angle / kRadiansPerDegree); }
double MillimetresUp(double length) { return kMetresPerMm * std::ceil(length / kMetresPerMm); }

constexpr double kMostRoom = 45.0 * kRadiansPerDegree;  // of a project (files/bounds.cpp)

/// By sphere, the one at its mirror image in the root link's x-z plane; itself if there is none.
std::vector<std::size_t> Images(const ProjectDraft& draft) {
  constexpr double kSame = 2e-3;
  const Eigen::Matrix3Xd centres = SphereCentres(
      draft.spheres,
      LinkTransforms(draft.tree, Eigen::VectorXd::Zero(draft.tree.coordinate_count())));
  std::vector<std::size_t> images;
  for (std::size_t a = 0; a < draft.spheres.size(); ++a) {
    Eigen::Vector3d wanted = centres.col(static_cast<Eigen::Index>(a));
    wanted.y() = -wanted.y();
    std::size_t image = a;
    for (std::size_t b = 0; b < draft.spheres.size(); ++b) {
      const double apart = (centres.col(static_cast<Eigen::Index>(b)) - wanted).norm();
      if (apart < kSame && draft.spheres[a].radius == draft.spheres[b].radius) image = b;
    }
    images.push_back(image);
  }
  return images;
}

}  // namespace

void BendLimbs(ProjectDraft& draft, const Semantics& semantics) {
  const auto [lower, upper] = RangesOf(draft.tree, 0.021);
  for (const BentRange& bent : BentRanges(draft.tree, draft.limbs, draft.rest.q)) {
    const int c = bent.coordinate;
    double& rest = draft.rest.q[c];
    Eigen::Vector2d range(DegreesDown(bent.range[0]), DegreesUp(bent.range[1]));
    if (bent.leg || !semantics.states.empty()) {
      range = {std::min(range[0], DegreesDown(rest)), std::max(range[1], DegreesUp(rest))};
    } else {
      rest = std::clamp(rest, std::max(range[0], lower[c]), std::min(range[1], upper[c]));
    }
    draft.bent_ranges[c] = range;
  }
}

void LeaveRoomForCorrections(ProjectDraft& draft) {
  auto [lower, upper] = RangesOf(draft.tree, 0.021);
  for (const auto& [c, range] : draft.bent_ranges) {
    lower[c] = std::max(lower[c], range[0]);
    upper[c] = std::min(upper[c], range[1]);
  }
  const std::vector<const Limb*> limbs = CorrectedLimbs(draft.tree, draft.limbs);
  std::map<int, double> sds;
  double displacement = 0.0;
  for (const Limb* limb : limbs) {
    const ExpectedCorrection typical =
        TypicalCorrection(draft.tree, *limb, lower, upper, draft.rest.q);
    displacement = std::max(displacement, typical.displacement);
    for (const auto& [c, sd] : typical.joints) sds[c] = std::max(sds[c], sd);
  }
  if (limbs.empty()) return;
  const double of_two = std::sqrt(2.0) * displacement;
  const double margin = RoomSds(limbs.size()) * of_two;
  draft.sphere_margin = std::max(draft.sphere_margin, MillimetresUp(margin));
  for (const auto& [c, sd] : sds) {
    const Joint& joint = draft.tree.joints[Size(draft.tree.coordinate_joint[Size(c)])];
    if (joint.type != JointType::kRevolute) continue;
    draft.room[c] = std::min(DegreesUp(RoomSds(sds.size()) * sd), kMostRoom);
  }
  for (const Limb* limb : limbs) {  // alike on both sides
    if (limb->mirror < 0) continue;
    const Limb& other = draft.limbs.limbs[Size(limb->mirror)];
    for (std::size_t i = 0; i < limb->joints.size(); ++i) {
      const auto of = [&](const Limb& side) {
        return draft.room.find(draft.tree.joints[Size(side.joints[i])].coordinate);
      };
      const auto here = of(*limb), there = of(other);
      if (here == draft.room.end() || there == draft.room.end()) continue;
      here->second = there->second = std::max(here->second, there->second);
    }
  }
}

void ShrinkToMargin(ProjectDraft& draft, const Semantics& semantics, double usual_margin) {
  std::set<SpherePair> moved;
  for (const ChainSetup& setup : draft.designs) {
    const auto pairs = PairsMovedBy(draft.tree, draft.spheres, setup.coordinates, semantics);
    moved.insert(pairs.begin(), pairs.end());
  }
  const std::vector<SpherePair> pairs(moved.begin(), moved.end());
  if (pairs.empty()) return;
  Eigen::ArrayXd least = Eigen::ArrayXd::Constant(static_cast<Eigen::Index>(pairs.size()),
                                                  std::numeric_limits<double>::infinity());
  for (const Eigen::VectorXd& rest : RestingPostures(draft)) {
    const std::vector<Transform> poses = LinkTransforms(draft.tree, rest);
    least = least.min(SphereDistances(draft.spheres, pairs, poses).array());
  }
  std::vector<double> less(draft.spheres.size(), 0.0);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double apart = least[static_cast<Eigen::Index>(i)];
    if (apart < usual_margin || apart >= draft.sphere_margin) continue;
    const double half = MillimetresUp(0.5 * (draft.sphere_margin - apart));
    for (const int s : {pairs[i].first, pairs[i].second}) {
      less[Size(s)] = std::max(less[Size(s)], half);
    }
  }
  const std::vector<std::size_t> images = Images(draft);
  for (std::size_t s = 0; s < draft.spheres.size(); ++s) {
    const double most = 0.5 * draft.spheres[s].radius;
    draft.spheres[s].radius -= std::min(most, std::max(less[s], less[images[s]]));
  }
}

}  // namespace elastocal
