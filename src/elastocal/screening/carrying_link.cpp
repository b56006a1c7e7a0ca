// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/carrying_link.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "elastocal/calibration/nominal_postures.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {
namespace {

constexpr double kLeastScatter = 0.02;  // m
constexpr double kLeftOnCarrier = 1.0 / 3.0;
constexpr double kRounding = 1e-9;
constexpr std::size_t kMostLookedAt = 60;  // postures that are examined
constexpr std::size_t kFewestTelling = 8;
constexpr std::size_t kFewestCarried = 3;  // fewer are often hidden, and do not tell a link

/// Positions of one marker in the frame of one link, m.
using PositionsOnLink = std::vector<Eigen::Vector3d>;

double SquaredScatter(const PositionsOnLink& positions) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : positions) mean += p / static_cast<double>(positions.size());
  double squares = 0.0;
  for (const Eigen::Vector3d& p : positions) squares += (p - mean).squaredNorm();
  return squares;
}

/// The nominal robot in some postures of a recording, with all links in the root link's frame.
class NominalLinks {
 public:
  NominalLinks(const ErrorModel& model, const Recording& recording)
      : recording_(recording), postures_(NominalPostures(model, recording, -1, kMostLookedAt)) {
    for (const NominalPosture& nominal : postures_) {
      links_.push_back(LinkTransforms(model.tree, recording.q.row(nominal.posture).transpose()));
    }
  }

  /// Root mean square distance of a cluster's markers from their mean positions in the frame of
  /// each link, m. Empty where too few postures show them.
  Eigen::ArrayXd ScatterOf(const std::vector<int>& markers) const {
    std::vector<std::optional<Transform>> roots;
    for (const NominalPosture& nominal : postures_) {
      roots.push_back(PlaceRoot(recording_, nominal, markers));
    }
    Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(postures_.empty() ? 0 : std::ssize(links_[0]));
    std::size_t seen = 0, most = 0;
    for (const int m : markers) {
      std::vector<std::size_t> postures;
      for (std::size_t i = 0; i < roots.size(); ++i) {
        if (roots[i] && Seen(recording_, postures_[i].posture, m)) postures.push_back(i);
      }
      for (Eigen::Index link = 0; link < squares.size(); ++link) {
        PositionsOnLink positions;
        for (const std::size_t i : postures) {
          const Transform T_ref_link = *roots[i] * links_[i][Size(link)];
          positions.push_back(T_ref_link.inverse() *
                              MarkerPosition(recording_, postures_[i].posture, m));
        }
        squares[link] += SquaredScatter(positions);
      }
      seen += postures.size();
      most = std::max(most, postures.size());
    }
    if (most < kFewestTelling) return {};
    return (squares / static_cast<double>(seen)).sqrt();
  }

 private:
  const Recording& recording_;
  std::vector<NominalPosture> postures_;
  std::vector<std::vector<Transform>> links_;  // by posture and link
};

}  // namespace

std::optional<CarryingLink> FindCarryingLink(const ErrorModel& model, const Recording& recording,
                                             const std::vector<LabelCluster>& clusters) {
  const NominalLinks robot(model, recording);
  std::optional<CarryingLink> found;
  for (const LabelCluster& cluster : clusters) {
    if (cluster.markers.size() < kFewestCarried) continue;
    const Eigen::ArrayXd scatter = robot.ScatterOf(cluster.markers);
    const int own = model.markers[Size(cluster.markers.front())].link;
    if (scatter.size() <= own || scatter[own] < kLeastScatter) continue;
    int carrier = -1;  // the first link of a body, which its joint moves
    double least = kLeftOnCarrier * scatter[own];
    for (int link = 0; link < scatter.size(); ++link) {
      if (!(scatter[link] < (1.0 - kRounding) * least)) continue;
      least = scatter[link];
      carrier = link;
    }
    if (carrier < 0) continue;
    if (found) return std::nullopt;
    found = {cluster.name, model.tree.links[Size(own)].name, model.tree.links[Size(carrier)].name,
             scatter[own], least};
  }
  return found;
}

std::string Describe(const CarryingLink& found) {
  char text[160];
  std::snprintf(text, sizeof text, " (%.3g mm rms)", 1e3 * found.on_carrier);
  const std::string carried = found.carrier + text;
  std::snprintf(text, sizeof text, " (%.3g mm rms): on which link are they?", 1e3 * found.on_own);
  return "cluster " + found.cluster + ": its markers move with " + carried + ", not with " +
         found.own + text;
}

}  // namespace elastocal
