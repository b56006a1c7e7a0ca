// SPDX-License-Identifier: Apache-2.0
#include "elastocal/report/scenes.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "elastocal/math/transform.hpp"
#include "elastocal/measurement/moments.hpp"
#include "elastocal/report/encoding.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMostPlayedMoments = 150;  // moments of a motion
constexpr int kMostPostures = 300;

/// A recording with the predictions of the models.
struct Predicted {
  const Recording& recording;
  const ByModel<Prediction>& predictions;
};

/// At most `most` postures, evenly chosen.
std::vector<int> Thinned(const std::vector<int>& postures, int most) {
  const auto count = static_cast<int>(postures.size());
  if (count <= most) return postures;
  std::vector<int> kept;
  for (int k = 0; k < most; ++k)
    kept.push_back(postures[static_cast<std::size_t>(k) * count / most]);
  return kept;
}

std::vector<int> MarkersSeen(const Recording& recording, const std::vector<int>& postures) {
  std::vector<int> markers;
  for (int m = 0; m < recording.marker_count(); ++m) {
    const auto seen = [&](int i) { return Seen(recording, i, m); };
    if (std::any_of(postures.begin(), postures.end(), seen)) markers.push_back(m);
  }
  return markers;
}

/// Transform from the frame of the recording to one with z up: by gravity where the waist moves,
/// else that of the waist.
Transform ToView(const CalibrationView& view) {
  const CalibrationResult& best = view.comparison.largest();
  if (!HasPoseByPosture(view.recording)) {
    return WaistPose(ApplyErrors(best.model, best.delta)).inverse();
  }
  Transform up = Transform::Identity();
  up.linear() = RotationBetween(-view.recording.gravity, Eigen::Vector3d::UnitZ());
  return up;
}

/// postures x 3 markers of `positions` (as Recording::markers), in the frame of the view.
Eigen::MatrixXd Points(const Eigen::MatrixXd& positions, const std::vector<int>& postures,
                       const std::vector<int>& markers, const Transform& T_view_ref) {
  Eigen::MatrixXd points(postures.size(), 3 * markers.size());
  for (std::size_t i = 0; i < postures.size(); ++i) {
    for (std::size_t m = 0; m < markers.size(); ++m) {
      const Eigen::Vector3d point = positions.block<1, 3>(postures[i], 3 * markers[m]).transpose();
      points.block<1, 3>(static_cast<Eigen::Index>(i), 3 * static_cast<Eigen::Index>(m)) =
          (T_view_ref * point).transpose();
    }
  }
  return points;
}

/// Position and quaternion (x, y, z, w) of the root link, one row a posture.
Eigen::MatrixXd Waists(const Placement& placement, const std::vector<int>& postures,
                       const Transform& T_view_ref) {
  Eigen::MatrixXd waists(postures.size(), 7);
  for (std::size_t i = 0; i < postures.size(); ++i) {
    Transform waist = Transform::Identity();
    if (!placement.empty()) waist = T_view_ref * placement.T_ref_waist[postures[i]];
    waists.row(static_cast<Eigen::Index>(i)) << waist.translation().transpose(),
        Eigen::Quaterniond(waist.linear()).coeffs().transpose();
  }
  return waists;
}

const char* KindText(TrialKind kind) {
  switch (kind) {
    case TrialKind::kSine:
      return "sine";
    case TrialKind::kRandom:
      return "random";
    case TrialKind::kRepeatability:
      return "repeatability";
    default:
      return "calibration";
  }
}

Json MakeScene(const CalibrationView& view, const Predicted& predicted, const Trial& trial,
               const std::vector<int>& all, const Transform& T_view_ref) {
  const Recording& recording = predicted.recording;
  const bool motion = trial.of_motion();
  const std::vector<int> postures = Thinned(all, motion ? kMostPlayedMoments : kMostPostures);
  const std::vector<int> markers = MarkersSeen(recording, postures);
  const ModelKind best = view.comparison.largest_kind();
  Json scene = {{"name", trial.name}, {"kind", KindText(trial.kind)}, {"total", all.size()}};
  scene["support"] = Json::array();
  for (const int link : trial.support) {
    scene["support"].push_back(view.comparison.largest().model.tree.links[link].name);
  }
  scene["time_s"] = Json::array();
  for (const int i : postures) {
    if (recording.time_s.size() > 0) scene["time_s"].push_back(Rounded(recording.time_s[i], 7));
  }
  scene["markers"] = markers;
  scene["q"] = Base64Floats(Eigen::MatrixXd(recording.q(postures, Eigen::all)));
  scene["waist"] = Base64Floats(
      Waists(predicted.predictions[static_cast<int>(best)].placement, postures, T_view_ref));
  scene["measured"] = Base64Floats(Points(recording.markers, postures, markers, T_view_ref));
  for (const ModelKind kind : {ModelKind::kUncalibrated, best}) {
    scene["predicted"][ModelKindName(kind)] = Base64Floats(Points(
        predicted.predictions[static_cast<int>(kind)].positions, postures, markers, T_view_ref));
  }
  return scene;
}

void AddScenes(const CalibrationView& view, const Predicted& predicted, Json& scenes) {
  const Transform T_view_ref = ToView(view);
  std::vector<Trial> trials = predicted.recording.trials;
  if (trials.empty()) trials.push_back({.name = "", .kind = TrialKind::kCalibration, .chains = {}});
  for (std::size_t t = 0; t < trials.size(); ++t) {
    const std::vector<int> postures = PosturesOfTrial(predicted.recording, static_cast<int>(t));
    if (postures.empty()) continue;
    scenes.push_back(MakeScene(view, predicted, trials[t], postures, T_view_ref));
  }
}

}  // namespace

nlohmann::ordered_json MakeScenes(const CalibrationView& view) {
  Json scenes = Json::array();
  AddScenes(view, {view.recording, view.comparison.predictions}, scenes);
  if (view.held_out != nullptr) {
    AddScenes(view, {view.validation, view.held_out->predictions}, scenes);
  }
  return scenes;
}

}  // namespace elastocal
