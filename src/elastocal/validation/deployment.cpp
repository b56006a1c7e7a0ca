// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/deployment.hpp"

#include <cmath>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

constexpr int kRobots = 20;  // robots drawn from the prior
constexpr int kMostPostures = 50;

}  // namespace

Deployment ChooseDeployment(const ModelComparison& comparison, const CrossValidation& validation,
                            const ErrorTable* table) {
  Deployment deployment;
  const bool on_trials = table != nullptr && !table->mean_rmse_3d.empty();
  const auto predicted = [&](ModelKind kind) {
    return std::isfinite(validation.metrics[static_cast<int>(kind)].rmse_3d);
  };
  const bool on_folds = !on_trials && validation.folds > 0 && predicted(ModelKind::kUncalibrated) &&
                        predicted(ModelKind::kGeometric);
  deployment.judged_on =
      on_trials ? "held-out trials" : (on_folds ? "held-out postures" : "the fit");
  const auto rmse = [&](ModelKind kind) {
    if (on_trials) {
      const auto at = table->mean_rmse_3d.find(kind);
      return at == table->mean_rmse_3d.end() ? kNaN : at->second;
    }
    const auto k = static_cast<int>(kind);
    return (on_folds ? validation.metrics : comparison.metrics_all)[k].rmse_3d;
  };
  const auto interval = [&](ModelKind kind) -> std::optional<RmseInterval> {
    if (!on_folds) return std::nullopt;
    return IntervalOfRmse(validation.distances[static_cast<int>(kind)], validation.unit_of);
  };
  deployment.uncalibrated = rmse(ModelKind::kUncalibrated);
  deployment.compensated = kNaN;
  deployment.urdf = rmse(ModelKind::kGeometric);
  if (comparison.largest_kind() == ModelKind::kFull) {
    deployment.compensated = rmse(ModelKind::kFull);
    deployment.compensated_interval = interval(ModelKind::kFull);
    if (rmse(ModelKind::kRigid) < deployment.urdf) {
      deployment.urdf_kind = ModelKind::kRigid;
      deployment.urdf = rmse(ModelKind::kRigid);
    }
  }
  deployment.urdf_interval = interval(deployment.urdf_kind);
  return deployment;
}

double ExpectedError(const ErrorModel& model, const Recording& recording, const Prior& prior) {
  const ObservationMask seen = SeenMask(recording);
  const Geometry nominal = ApplyErrors(model, Eigen::VectorXd::Zero(model.parameter_count()));
  const int stride = 1 + recording.posture_count() / kMostPostures;
  Random random(1);
  double squares = 0.0;
  double count = 0.0;
  for (int robot = 0; robot < kRobots; ++robot) {
    Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
    for (int k = 0; k < delta.size(); ++k) {
      const Parameter& parameter = model.parameters[k];
      const bool of_robot = parameter.joint >= 0 || parameter.linkage >= 0;
      if (!of_robot || IsElastic(parameter.kind)) continue;
      delta[k] = random.Normal(prior.Of(model.tree, parameter));
    }
    const Geometry drawn = ApplyErrors(model, delta);
    for (int i = 0; i < recording.posture_count(); i += stride) {
      const Eigen::VectorXd q = recording.q.row(i).transpose();
      const Eigen::Matrix3Xd moved =
          MarkerPositions(model, drawn, q) - MarkerPositions(model, nominal, q);
      for (int m = 0; m < recording.marker_count(); ++m) {
        if (!seen(i, m)) continue;
        squares += moved.col(m).squaredNorm();
        count += 1.0;
      }
    }
  }
  return count > 0.0 ? std::sqrt(squares / count) : kNaN;
}

}  // namespace elastocal
