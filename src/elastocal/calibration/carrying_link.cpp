// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/carrying_link.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "elastocal/calibration/nominal_postures.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

constexpr double kLeastScatter = 0.02;  // m
constexpr double kLeftOnCarrier = 1.0 / 3.0;
constexpr std::size_t kMostLookedAt = 60;  // postures
constexpr std::size_t kFewestTelling = 8;

/// Positions of one marker in the frame of one body, m.
using PositionsOnBody = std::vector<Eigen::Vector3d>;

double SquaredScatter(const PositionsOnBody& track) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : track) mean += p / static_cast<double>(track.size());
  double squares = 0.0;
  for (const Eigen::Vector3d& p : track) squares += (p - mean).squaredNorm();
  return squares;
}

/// The nominal robot in some postures of a recording, with its bodies in the root link's frame.
class NominalBodies {
 public:
  NominalBodies(const ErrorModel& model, const Recording& recording)
      : recording_(recording), postures_(NominalPostures(model, recording, -1, kMostLookedAt)) {
    ErrorModel at_origin = model;
    at_origin.T_ref_waist = Transform::Identity();
    const Geometry geometry =
        ApplyErrors(at_origin, Eigen::VectorXd::Zero(at_origin.parameter_count()));
    for (const NominalPosture& nominal : postures_) {
      bodies_.push_back(
          BodyTransforms(at_origin, geometry, recording.q.row(nominal.posture).transpose()));
    }
  }

  /// rms distance of a cluster's markers from their mean positions on each body, m; empty where too
  /// few postures tell.
  Eigen::ArrayXd ScatterOf(const std::vector<int>& markers) const {
    if (postures_.empty()) return {};
    const std::size_t count = bodies_.front().size();
    Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(static_cast<Eigen::Index>(count));
    std::size_t seen = 0, most = 0;
    for (const int m : markers) {
      const std::vector<PositionsOnBody> tracks = TracksOf(m, markers);
      for (std::size_t b = 0; b < count; ++b) {
        squares[static_cast<Eigen::Index>(b)] += SquaredScatter(tracks[b]);
      }
      seen += tracks.front().size();
      most = std::max(most, tracks.front().size());
    }
    if (most < kFewestTelling) return {};
    return (squares / static_cast<double>(seen)).sqrt();
  }

 private:
  /// Of a marker, by body.
  std::vector<PositionsOnBody> TracksOf(int marker, const std::vector<int>& cluster) const {
    std::vector<PositionsOnBody> tracks(bodies_.front().size());
    for (std::size_t i = 0; i < postures_.size(); ++i) {
      if (!Seen(recording_, postures_[i].posture, marker)) continue;
      const auto T_ref_root = PlaceRoot(recording_, postures_[i], cluster);
      if (!T_ref_root) continue;
      const Eigen::Vector3d in_root =
          T_ref_root->inverse() * MarkerPosition(recording_, postures_[i].posture, marker);
      for (std::size_t b = 0; b < tracks.size(); ++b) {
        tracks[b].push_back(bodies_[i][b].inverse() * in_root);
      }
    }
    return tracks;
  }

  const Recording& recording_;
  std::vector<NominalPosture> postures_;
  std::vector<std::vector<Transform>> bodies_;  // by posture
};

}  // namespace

std::optional<CarryingLink> FindCarryingLink(const ErrorModel& model, const Recording& recording,
                                             const std::vector<LabelCluster>& clusters) {
  const NominalBodies nominal(model, recording);
  const std::vector<int>& active = model.active_joints;
  std::optional<CarryingLink> found;
  for (const LabelCluster& cluster : clusters) {
    if (cluster.markers.size() < 2) continue;
    const Eigen::ArrayXd scatter = nominal.ScatterOf(cluster.markers);
    const int own = model.markers[Size(cluster.markers.front())].link;
    const int body = model.tree.links[Size(own)].body;
    if (scatter.size() <= body || scatter[body] < kLeastScatter) continue;
    int carrier = -1;
    double least = kLeftOnCarrier * scatter[body];
    for (std::size_t k = 0; k < model.tree.links.size();
         ++k) {  // the first of a body is moved by its joint
      const int other = model.tree.links[k].body;
      const bool placed =
          other == 0 || std::find(active.begin(), active.end(), other - 1) != active.end();
      if (!placed || other == body || !(scatter[other] < least)) continue;
      least = scatter[other];
      carrier = static_cast<int>(k);
    }
    if (carrier < 0) continue;
    if (found) return std::nullopt;
    found = {cluster.name, model.tree.links[Size(own)].name, model.tree.links[Size(carrier)].name,
             scatter[body], least};
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
