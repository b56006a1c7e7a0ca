// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/placement.hpp"

#include <algorithm>
#include <optional>

#include "elastocal/calibration/registration.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

constexpr int kNoLeg = -2;

/// The leg that a trial stands on; -1: its root is held; kNoLeg: anything else.
int SupportOf(const ErrorModel& model, const Trial& trial) {
  if (trial.support.empty()) return trial.free_root ? kNoLeg : -1;
  if (trial.support.size() > 1) return kNoLeg;
  for (int leg = 0; leg < model.leg_count(); ++leg) {
    if (model.legs[leg].link == trial.support[0]) return leg;
  }
  return kNoLeg;
}

std::vector<int> MarkersOfBody(const ErrorModel& model, int body) {
  std::vector<int> markers;
  for (int m = 0; m < model.marker_count(); ++m) {
    if (model.tree.links[model.markers[m].link].body == body) markers.push_back(m);
  }
  return markers;
}

/// Mean positions of the markers of a foot since it last moved.
class FootTrack {
 public:
  explicit FootTrack(std::vector<int> markers)
      : markers_(std::move(markers)),
        sums_(Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(markers_.size()))),
        counts_(Eigen::VectorXd::Zero(sums_.cols())) {}

  /// Median distance of the markers seen in a posture from their means; 0 where none was seen.
  double Distance(const Recording& recording, int posture) const {
    std::vector<double> distances;
    for (std::size_t k = 0; k < markers_.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      if (counts_[i] == 0.0 || !Seen(recording, posture, markers_[k])) continue;
      distances.push_back(
          (MarkerPosition(recording, posture, markers_[k]) - sums_.col(i) / counts_[i]).norm());
    }
    if (distances.empty()) return 0.0;
    return Median(
        Eigen::Map<Eigen::VectorXd>(distances.data(), static_cast<Eigen::Index>(distances.size())));
  }

  void Add(const Recording& recording, int posture) {
    for (std::size_t k = 0; k < markers_.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      if (!Seen(recording, posture, markers_[k])) continue;
      sums_.col(i) += MarkerPosition(recording, posture, markers_[k]);
      counts_[i] += 1.0;
    }
  }

 private:
  std::vector<int> markers_;
  Eigen::Matrix3Xd sums_;
  Eigen::VectorXd counts_;
};

}  // namespace

std::vector<Footing> FindFootings(const ErrorModel& model, const Recording& recording,
                                  double slip_m, std::vector<Slip>* slips) {
  std::vector<Footing> footings;
  for (std::size_t t = 0; t < recording.trials.size(); ++t) {
    const int trial = static_cast<int>(t);
    const int leg = SupportOf(model, recording.trials[t]);
    if (leg == kNoLeg) continue;
    const int body = leg < 0 ? 0 : model.tree.links[model.legs[leg].link].body;
    const std::vector<int> markers = MarkersOfBody(model, body);
    std::optional<FootTrack> track;
    for (int i = 0; i < recording.posture_count(); ++i) {
      if (recording.trial[i] != trial) continue;
      const double distance = track ? track->Distance(recording, i) : 0.0;
      if (!track || distance > slip_m) {
        if (track && slips != nullptr) slips->push_back({trial, leg, i, distance});
        footings.push_back({trial, leg, {}});
        track.emplace(markers);
      }
      track->Add(recording, i);
      footings.back().postures.push_back(i);
    }
  }
  return footings;
}

Placement RegisterPlacement(const ErrorModel& model, const Recording& recording, double slip_m) {
  Placement placement;
  if (!HasPoseByPosture(recording)) return placement;
  const auto poses = RegisterWaistByPosture(model, recording);
  for (const auto& pose : poses) {
    placement.T_ref_waist.push_back(pose.value_or(Transform::Identity()));
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (poses[i]) continue;
    placement.T_ref_waist[i] =
        placement.T_ref_waist[i > 0 ? i - 1 : std::min<std::size_t>(1, poses.size() - 1)];
  }
  placement.footings = FindFootings(model, recording, slip_m);
  placement.footing.assign(recording.posture_count(), -1);
  for (std::size_t f = 0; f < placement.footings.size(); ++f) {
    const Footing& footing = placement.footings[f];
    for (int i : footing.postures) placement.footing[i] = static_cast<int>(f);
    const int first = footing.postures.front();
    Transform T_waist_foot = Transform::Identity();
    if (footing.leg >= 0) {
      T_waist_foot = LinkTransforms(
          model.tree, recording.q.row(first).transpose())[model.legs[footing.leg].link];
    }
    placement.T_ref_footing.push_back(placement.T_ref_waist[first] * T_waist_foot);
  }
  return placement;
}

}  // namespace elastocal
