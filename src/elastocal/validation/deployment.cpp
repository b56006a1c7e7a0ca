#include "elastocal/validation/deployment.hpp"

#include "elastocal/math/numbers.hpp"

namespace elastocal {

Deployment ChooseDeployment(const ModelComparison& comparison, const CrossValidation& validation,
                            const ErrorTable* table) {
  Deployment deployment;
  const bool on_trials = table != nullptr && !table->mean_rmse_3d.empty();
  const bool on_folds = !on_trials && validation.folds > 0;
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
  deployment.uncalibrated = rmse(ModelKind::kUncalibrated);
  deployment.urdf = rmse(ModelKind::kGeometric);
  deployment.compensated = kNaN;
  if (comparison.largest_kind() != ModelKind::kFull) return deployment;
  deployment.compensated = rmse(ModelKind::kFull);
  if (rmse(ModelKind::kRigid) < deployment.urdf) {
    deployment.urdf_kind = ModelKind::kRigid;
    deployment.urdf = rmse(ModelKind::kRigid);
  }
  return deployment;
}

}  // namespace elastocal
