#pragma once

#include <vector>

#include "elastocal/calibration/fit.hpp"
#include "elastocal/calibration/residuals.hpp"

namespace elastocal {

/// The prior as wide as the fit has it.
Prior WidenedPrior(const FitProblem& problem, const Fit& fit);

/// Whether any elastic parameter is estimated or known: else loads do not matter.
bool IsElasticFit(const ErrorModel& model, const std::vector<int>& free,
                  const Eigen::VectorXd& delta);

/// The residuals of a fit as it stands, with all that they refer to.
struct FitResiduals {
  FitResiduals(const FitProblem& problem, const Selection& selection, const std::vector<int>& free,
               const Fit& fit);
  FitResiduals(const FitResiduals&) = delete;
  FitResiduals& operator=(const FitResiduals&) = delete;

  Prior prior;
  Noise noise;
  Placement placement;
  std::vector<PostureLoads> loads;
  BodyResiduals body;
};

}  // namespace elastocal
