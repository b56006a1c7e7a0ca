// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/joint_gains.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "elastocal/calibration/prediction.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/validation/common_parameters.hpp"

namespace elastocal {
namespace {

constexpr int kTrainingPostures = 400;  // training postures that place markers
constexpr int kRefits = 3;      // rounds of refitting: placing feet and fitting markers alternate
constexpr double kMoves = 0.1;  // share of a joint's largest displacement
constexpr double kMeasuredWrong = 6.0;  // times the median distance

/// Whether an export contains the parameter.
bool IsCarried(const Parameter& parameter, const GainOptions& gains) {
  if (gains.nominal.contains(OwnerName(parameter.name))) return false;
  if (parameter.kind == ParameterKind::kTorqueBias) return false;
  if (parameter.kind == ParameterKind::kCorrection) return gains.causes.contains(parameter.name);
  return gains.with_loads || !IsElastic(parameter.kind);
}

Recording EvenlyChosen(const Recording& recording) {
  const int postures = recording.posture_count();
  if (postures <= kTrainingPostures) return recording;
  std::vector<int> chosen;
  for (int i = 0; i < kTrainingPostures; ++i) {
    chosen.push_back(static_cast<int>(static_cast<long>(i) * postures / kTrainingPostures));
  }
  return SelectPostures(recording, chosen);
}

/// A model with errors, markers and the waist's nominal pose.
struct PlacedErrors {
  ErrorModel model;
  Eigen::VectorXd delta;
};

/// Computes displacements of a split's held-out markers caused by changes of the errors.
class SplitDisplacements {
 public:
  SplitDisplacements(const HeldOutSplit& split, const CalibrationOptions& options,
                     const std::set<std::string>& known_markers)
      : split_(split), options_(options), training_(EvenlyChosen(split.training)) {
    for (const std::string& name : training_.marker_names) {
      known_.push_back(known_markers.contains(name));
    }
    from_ = {split.model, split.delta};
    before_ = Predict(from_.model, from_.delta, training_, options_);
    seen_ = SeenMask(training_);
    held_out_before_ = HeldOutPositions(from_, before_.placement);
  }

  /// Measured minus predicted positions of the held-out markers, m; NaN where unknown.
  Eigen::MatrixXd Residuals() const { return split_.held_out.markers - held_out_before_; }

  /// Displacement of the held-out markers, m, where the errors become `delta` and markers and waist
  /// are refitted to the training postures.
  Eigen::MatrixXd To(const Eigen::VectorXd& delta) const {
    PlacedErrors to{from_.model, delta};
    Prediction now;
    for (int i = 0; i <= kRefits; ++i) {
      now = Predict(to.model, to.delta, training_, options_);
      if (i < kRefits) Refit(now, to);
    }
    return HeldOutPositions(to, now.placement) - held_out_before_;
  }

 private:
  Eigen::MatrixXd HeldOutPositions(const PlacedErrors& errors, const Placement& placement) const {
    return Predict(errors.model, errors.delta, split_.held_out, options_,
                   split_.same_trials ? &placement : nullptr)
        .positions;
  }

  /// Displacement of each marker in a posture by one metre along each axis of its link's frame: 3 x
  /// 3 each.
  std::vector<Eigen::Matrix3d> MarkerAxes(const PlacedErrors& errors, const Placement& placement,
                                          int posture) const {
    Geometry geometry = ApplyErrors(errors.model, errors.delta);
    if (!placement.empty()) {
      PlaceWaist(placement.T_ref_waist[static_cast<std::size_t>(posture)], Vector6d::Zero(),
                 geometry);
    }
    const Eigen::VectorXd q = training_.q.row(posture).transpose();
    const Eigen::Matrix3Xd at = MarkerPositions(errors.model, geometry, q);
    std::vector<Eigen::Matrix3d> axes(static_cast<std::size_t>(at.cols()));
    for (int axis = 0; axis < 3; ++axis) {
      Geometry shifted = geometry;
      for (std::size_t m = 0; m < axes.size(); ++m) {
        shifted.p_joint_marker[m] += geometry.R_joint_link[m].col(axis);
      }
      const Eigen::Matrix3Xd there = MarkerPositions(errors.model, shifted, q);
      for (std::size_t m = 0; m < axes.size(); ++m) {
        const auto column = static_cast<Eigen::Index>(m);
        axes[m].col(axis) = there.col(column) - at.col(column);
      }
    }
    return axes;
  }

  /// Displaces the markers (without known ones) and, in a posture table, the waist so that the
  /// training postures are predicted as before: one Gauss-Newton step, markers eliminated.
  void Refit(const Prediction& now, PlacedErrors& to) const {
    const int markers = training_.marker_count();
    const bool with_waist = !HasPoseByPosture(training_);
    using Matrix36 = Eigen::Matrix<double, 3, 6>;
    std::vector<Eigen::Vector3d> pull(static_cast<std::size_t>(markers), Eigen::Vector3d::Zero());
    std::vector<Matrix36> by_waist(static_cast<std::size_t>(markers), Matrix36::Zero());
    Eigen::VectorXd count = Eigen::VectorXd::Zero(markers);
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Vector6d gradient = Vector6d::Zero();
    for (int i = 0; i < training_.posture_count(); ++i) {
      if (!now.positions.row(i).allFinite() || !before_.positions.row(i).allFinite()) continue;
      const std::vector<Eigen::Matrix3d> axes = MarkerAxes(to, now.placement, i);
      for (int m = 0; m < markers; ++m) {
        if (!seen_(i, m)) continue;
        const auto index = static_cast<std::size_t>(m);
        const Eigen::Vector3d at = now.positions.block<1, 3>(i, 3 * m).transpose();
        const Eigen::Vector3d error = before_.positions.block<1, 3>(i, 3 * m).transpose() - at;
        Matrix36 B;
        B << Eigen::Matrix3d::Identity(), -Skew(at);
        normal += B.transpose() * B;
        gradient += B.transpose() * error;
        if (known_[index]) continue;
        pull[index] += axes[index].transpose() * error;
        by_waist[index] += axes[index].transpose() * B;
        count[m] += 1.0;
      }
    }
    Vector6d twist = Vector6d::Zero();
    if (with_waist) {
      const double scale = normal.diagonal().maxCoeff();
      for (int m = 0; m < markers; ++m) {
        if (count[m] == 0.0) continue;
        const auto index = static_cast<std::size_t>(m);
        normal -= by_waist[index].transpose() * by_waist[index] / count[m];
        gradient -= by_waist[index].transpose() * pull[index] / count[m];
      }
      // Regularises directions of the waist that the markers alone can explain.
      normal.diagonal().array() += 1e-9 * scale;
      twist = normal.ldlt().solve(gradient);
      Transform moved = Transform::Identity();
      moved.linear() = RotationFromVector(twist.tail<3>());
      moved.translation() = twist.head<3>();
      to.model.T_ref_waist = moved * to.model.T_ref_waist;
    }
    const int first = to.model.parameter_count() - 3 * to.model.marker_count();
    for (int m = 0; m < markers; ++m) {
      const auto index = static_cast<std::size_t>(m);
      if (count[m] == 0.0) continue;
      to.delta.segment<3>(first + 3 * m) += (pull[index] - by_waist[index] * twist) / count[m];
    }
  }

  const HeldOutSplit& split_;
  const CalibrationOptions& options_;
  Recording training_;
  std::vector<bool> known_;  // by marker
  PlacedErrors from_;
  Prediction before_;
  ObservationMask seen_;
  Eigen::MatrixXd held_out_before_;
};

/// The errors that a split exports.
const Eigen::VectorXd& Exported(const HeldOutSplit& split) {
  return split.exported.size() > 0 ? split.exported : split.delta;
}

/// Joints and legs with exported errors, in the order of the model.
std::vector<std::string> OwnersWithErrors(const std::vector<HeldOutSplit>& splits,
                                          const GainOptions& gains) {
  std::vector<std::string> owners;
  for (const HeldOutSplit& split : splits) {
    for (int i = 0; i < split.model.parameter_count(); ++i) {
      const Parameter& parameter = split.model.parameters[static_cast<std::size_t>(i)];
      if (IsExternal(parameter.kind) || !IsCarried(parameter, gains)) continue;
      const std::string owner = OwnerName(parameter.name);
      if (Exported(split)[i] == 0.0 || std::ranges::find(owners, owner) != owners.end()) continue;
      owners.push_back(owner);
    }
  }
  return owners;
}

/// Held-out observations, one a column.
using Observations = Eigen::Matrix3Xd;

/// Residuals of the held-out observations with every joint corrected, and displacements by each
/// joint where it returns to nominal.
struct HeldOutErrors {
  Observations estimate;  ///< residual with the whole estimate, also what an export does not carry
  Observations residual;
  std::vector<Observations> by_owner;
  Observations by_all;  ///< displacement by all joints together
  int left_out = 0;
};

double Rms(const Observations& observations) {
  return std::sqrt(observations.colwise().squaredNorm().mean());
}

/// Appends the columns of postures x 3 markers where `mask` is set.
void Append(const Eigen::MatrixXd& rows, const ObservationMask& mask, Observations& all) {
  Eigen::Index next = all.cols();
  all.conservativeResize(3, next + mask.count());
  for (Eigen::Index i = 0; i < mask.rows(); ++i) {
    for (Eigen::Index m = 0; m < mask.cols(); ++m) {
      if (mask(i, m)) all.col(next++) = rows.block<1, 3>(i, 3 * m).transpose();
    }
  }
}

void AddSplit(const HeldOutSplit& split, const CalibrationOptions& options,
              const std::vector<std::string>& owners, const GainOptions& gains,
              HeldOutErrors& errors) {
  const SplitDisplacements displacements(split, options, gains.known_markers);
  Eigen::VectorXd deployed = Exported(split), nominal = split.delta;
  for (int i = 0; i < split.model.parameter_count(); ++i) {
    const Parameter& parameter = split.model.parameters[static_cast<std::size_t>(i)];
    if (IsExternal(parameter.kind)) continue;
    nominal[i] = 0.0;
    if (!IsCarried(parameter, gains)) deployed[i] = 0.0;
  }
  const Eigen::MatrixXd base = displacements.To(deployed);
  const Eigen::MatrixXd residuals = displacements.Residuals() - base;
  const ObservationMask seen = SeenMask(split.training);
  ObservationMask mask(residuals.rows(), residuals.cols() / 3);
  for (Eigen::Index i = 0; i < mask.rows(); ++i) {
    for (Eigen::Index m = 0; m < mask.cols(); ++m) {
      // A marker without training data has no position.
      mask(i, m) = seen.col(m).any() && residuals.block<1, 3>(i, 3 * m).allFinite();
    }
  }
  Append(displacements.Residuals(), mask, errors.estimate);
  Append(residuals, mask, errors.residual);
  Append(displacements.To(nominal) - base, mask, errors.by_all);
  for (std::size_t k = 0; k < owners.size(); ++k) {
    Eigen::VectorXd without = deployed;
    for (int i = 0; i < split.model.parameter_count(); ++i) {
      const Parameter& parameter = split.model.parameters[static_cast<std::size_t>(i)];
      if (!IsExternal(parameter.kind) && OwnerName(parameter.name) == owners[k]) without[i] = 0.0;
    }
    Append(displacements.To(without) - base, mask, errors.by_owner[k]);
  }
}

/// Leaves out observations further than kMeasuredWrong times the median from the estimate.
void LeaveOutWrongOnes(HeldOutErrors& errors) {
  std::vector<double> distances(static_cast<std::size_t>(errors.estimate.cols()));
  for (std::size_t i = 0; i < distances.size(); ++i) {
    distances[i] = errors.estimate.col(static_cast<Eigen::Index>(i)).norm();
  }
  std::vector<double> sorted = distances;
  std::ranges::nth_element(sorted, sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2));
  const double limit = kMeasuredWrong * sorted[sorted.size() / 2];
  std::vector<Eigen::Index> good;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    if (distances[i] <= limit) good.push_back(static_cast<Eigen::Index>(i));
  }
  errors.left_out = static_cast<int>(distances.size() - good.size());
  const auto keep = [&](Observations& all) { all = Observations(all(Eigen::all, good)); };
  keep(errors.residual);
  keep(errors.by_all);
  for (Observations& one : errors.by_owner) keep(one);
}

/// Indices of the observations that a joint moves.
std::vector<Eigen::Index> Moved(const Observations& displacement) {
  const Eigen::VectorXd sizes = displacement.colwise().norm();
  const double least = std::max(kMoves * sizes.maxCoeff(), 1e-12);
  std::vector<Eigen::Index> moved;
  for (Eigen::Index i = 0; i < sizes.size(); ++i) {
    if (sizes[i] >= least) moved.push_back(i);
  }
  return moved;
}

/// Computes the gain of a joint from the present residuals.
void TakeGain(const Observations& residual, const Observations& displacement, JointGain& joint) {
  const std::vector<Eigen::Index> moved = Moved(displacement);
  joint.observations = static_cast<int>(moved.size());
  joint.rmse = joint.gain = 0.0;
  if (moved.empty()) return;
  const Observations with = residual(Eigen::all, moved);
  const Observations without = with - displacement(Eigen::all, moved);
  joint.rmse = Rms(with);
  joint.gain = Rms(without) - joint.rmse;
}

}  // namespace

GainStudy StudyGains(const std::vector<HeldOutSplit>& splits, const CalibrationOptions& options,
                     const GainOptions& gains) {
  const std::vector<std::string> owners = OwnersWithErrors(splits, gains);
  HeldOutErrors errors;
  errors.by_owner.resize(owners.size());
  for (const HeldOutSplit& split : splits) {
    AddSplit(split, options, owners, gains, errors);
  }
  if (errors.residual.cols() == 0) {
    throw InputError("no marker of the calibration was seen in held-out postures");
  }
  LeaveOutWrongOnes(errors);

  GainStudy study;
  study.observations = static_cast<int>(errors.residual.cols());
  study.left_out = errors.left_out;
  study.all = Rms(errors.residual);
  study.uncalibrated = Rms(errors.residual - errors.by_all);
  for (const std::string& owner : owners) study.joints.push_back({.owner = owner});
  Observations residual = errors.residual;
  while (true) {
    std::size_t least = owners.size();
    for (std::size_t k = 0; k < owners.size(); ++k) {
      JointGain& joint = study.joints[k];
      if (!joint.kept) continue;
      TakeGain(residual, errors.by_owner[k], joint);
      if (least == owners.size() || joint.gain < study.joints[least].gain) least = k;
    }
    if (least == owners.size() || study.joints[least].gain > gains.least) break;
    study.joints[least].kept = false;
    residual -= errors.by_owner[least];
  }
  study.kept = Rms(residual);
  return study;
}

}  // namespace elastocal
