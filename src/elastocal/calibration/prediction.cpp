// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/prediction.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "elastocal/calibration/loads.hpp"
#include "elastocal/calibration/outliers.hpp"
#include "elastocal/calibration/placing_markers.hpp"
#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/robot/leg_load.hpp"

namespace elastocal {
namespace {

/// Pairs of points from which a rigid transform is fitted.
class Registration {
 public:
  void Add(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    from_.push_back(from);
    to_.push_back(to);
  }
  std::optional<Transform> Solve() const { return FitRigid(from_, to_); }

 private:
  std::vector<Eigen::Vector3d> from_, to_;
};

/// Adds the markers seen in a posture for which `takes(marker)` is true.
template <typename Takes>
void AddMarkers(const Recording& recording, int posture, const Eigen::Matrix3Xd& positions,
                const Takes& takes, Registration& registration) {
  for (int m = 0; m < recording.marker_count(); ++m) {
    if (takes(m) && Seen(recording, posture, m)) {
      registration.Add(positions.col(m), MarkerPosition(recording, posture, m));
    }
  }
}

/// The pose in `known` of a footing with the same trial and leg. Null if there is none, or if that
/// foot slipped, so that several footings match.
const Transform* FindKnown(const Placement* known, const Footing& footing) {
  const Transform* found = nullptr;
  for (std::size_t f = 0; known != nullptr && f < known->footings.size(); ++f) {
    const Footing& candidate = known->footings[f];
    if (candidate.trial != footing.trial || candidate.leg != footing.leg) continue;
    if (found != nullptr) return nullptr;
    found = &known->T_ref_footing[f];
  }
  return found;
}

class Predictor {
 public:
  Predictor(const ErrorModel& model, const Eigen::VectorXd& delta, const Recording& recording,
            const CalibrationOptions& options, const Placement* known, FootingBy by)
      : model_(model), recording_(recording), geometry_(ApplyErrors(model, delta)), by_(by) {
    placement_ = RegisterPlacement(model, recording, options.slip);
    PlaceWaist(Transform::Identity(), Vector6d::Zero(), geometry_);
    const auto all = [](int) { return true; };
    for (int i = 0; i < recording.posture_count(); ++i) {
      InterruptionPoint();
      Registration registration;
      AddMarkers(recording, i, MarkerPositions(model, geometry_, Q(i)), all, registration);
      if (const auto T = registration.Solve()) placement_.T_ref_waist[i] = *T;
    }
    loads_ = ComputeLoads(model, recording, delta, placement_, options.load);
    for (std::size_t f = 0; f < placement_.footings.size(); ++f) PlaceFooting(f, known);
    for (int i = 0; i < recording.posture_count(); ++i) {
      InterruptionPoint();
      if (placement_.footing[i] < 0) PlaceByMarkers(i);
    }
  }

  Prediction Result() && {
    Prediction prediction;
    prediction.positions.resize(recording_.posture_count(), recording_.markers.cols());
    for (int i = 0; i < recording_.posture_count(); ++i) {
      InterruptionPoint();
      prediction.positions.row(i) = Markers(i).reshaped().transpose();
    }
    prediction.distances = MarkerDistances(recording_, prediction.positions);
    prediction.placement = std::move(placement_);
    return prediction;
  }

 private:
  Eigen::VectorXd Q(int posture) const { return recording_.q.row(posture).transpose(); }
  Eigen::Matrix3Xd MarkersInWaist(int posture) const {
    return MarkerPositions(model_, geometry_, Q(posture), loads_[posture].joints);
  }
  bool OnFoot(int leg, int marker) const {
    return model_.tree.links[model_.markers[marker].link].body ==
           model_.tree.links[model_.legs[leg].link].body;
  }
  /// Positions in the foot's frame. Markers on the foot itself do not depend on the leg.
  Eigen::Matrix3Xd MarkersInFoot(int leg, int posture, const Transform& T_foot_waist) const {
    Eigen::Matrix3Xd positions = T_foot_waist * MarkersInWaist(posture);
    if (leg < 0) return positions;
    const int foot = model_.legs[leg].link;
    for (int m = 0; m < model_.marker_count(); ++m) {
      if (OnFoot(leg, m)) positions.col(m) = PlaceMarker(model_, geometry_, m, foot).position;
    }
    return positions;
  }

  Eigen::Matrix3Xd Markers(int posture) const {
    const int footing = placement_.footing[posture];
    if (footing < 0) return placement_.T_ref_waist[posture] * MarkersInWaist(posture);
    const Transform& T_ref_foot = placement_.T_ref_footing[footing];
    return T_ref_foot * MarkersInFoot(placement_.footings[footing].leg, posture,
                                      T_ref_foot.inverse() * placement_.T_ref_waist[posture]);
  }

  Transform WaistOnFoot(int leg, int posture) const {
    if (leg < 0) return Transform::Identity();
    const LegPosture rigid = PlaceLeg(model_, geometry_, Q(posture), leg, loads_[posture].joints);
    const Vector6d wrench = loads_[posture].WaistLoad(model_, geometry_, leg);
    return DeflectWaist(rigid.T_foot_waist, geometry_.leg_compliance[leg], wrench).T_foot_waist;
  }

  /// Markers that place a footing, see FootingBy.
  std::vector<char> MarkersThatPlace(const Footing& footing) const {
    std::vector<char> all(model_.marker_count(), 1);
    if (by_ != FootingBy::kFootMarkers || footing.leg < 0) return all;
    std::vector<char> on_foot(model_.marker_count(), 0);
    int count = 0;
    for (int m = 0; m < model_.marker_count(); ++m) {
      const bool seen = std::any_of(footing.postures.begin(), footing.postures.end(),
                                    [&](int i) { return Seen(recording_, i, m); });
      if (!seen || !OnFoot(footing.leg, m)) continue;
      on_foot[m] = 1;
      ++count;
    }
    return count < 3 ? all : on_foot;
  }

  void PlaceFooting(std::size_t f, const Placement* known) {
    const Footing& footing = placement_.footings[f];
    const std::vector<char> placing = MarkersThatPlace(footing);
    std::vector<Transform> T_foot_waist;
    Registration registration;
    for (int i : footing.postures) {
      T_foot_waist.push_back(WaistOnFoot(footing.leg, i));
      AddMarkers(
          recording_, i, MarkersInFoot(footing.leg, i, T_foot_waist.back()),
          [&](int m) { return placing[m] != 0; }, registration);
    }
    if (const Transform* T = FindKnown(known, footing)) {
      placement_.T_ref_footing[f] = *T;
    } else if (const auto fitted = registration.Solve()) {
      placement_.T_ref_footing[f] = *fitted;
    }
    for (std::size_t k = 0; k < footing.postures.size(); ++k) {
      placement_.T_ref_waist[footing.postures[k]] = placement_.T_ref_footing[f] * T_foot_waist[k];
    }
  }

  void PlaceByMarkers(int posture) {
    Registration registration;
    const std::vector<int> placing = PlacingMarkers(model_, recording_, posture);
    const bool by_all = by_ == FootingBy::kAllOfPosture && HasFreeRoot(recording_, posture);
    const auto places = [&](int m) {
      return by_all || std::binary_search(placing.begin(), placing.end(), m);
    };
    AddMarkers(recording_, posture, MarkersInWaist(posture), places, registration);
    const auto T = registration.Solve();
    if (T) {
      placement_.T_ref_waist[posture] = *T;
    } else {
      placement_.T_ref_waist[posture].matrix().setConstant(kNaN);
    }
  }

  const ErrorModel& model_;
  const Recording& recording_;
  Geometry geometry_;
  FootingBy by_;
  Placement placement_;
  std::vector<PostureLoads> loads_;
};

}  // namespace

Prediction Predict(const ErrorModel& model, const Eigen::VectorXd& delta,
                   const Recording& recording, const CalibrationOptions& options,
                   const Placement* footings, FootingBy by) {
  if (!HasPoseByPosture(recording)) {
    Prediction prediction;
    prediction.positions = PredictedPositions(model, recording, delta, options);
    prediction.distances = MarkerDistances(recording, prediction.positions);
    return prediction;
  }
  return Predictor(model, delta, recording, options, footings, by).Result();
}

}  // namespace elastocal
