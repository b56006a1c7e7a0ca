#include "elastocal/calibration/fit_residuals.hpp"

#include <algorithm>

namespace elastocal {

Prior WidenedPrior(const FitProblem& problem, const Fit& fit) {
  return problem.options.prior.Scaled(fit.prior_scale);
}

bool IsElasticFit(const ErrorModel& model, const std::vector<int>& free,
                  const Eigen::VectorXd& delta) {
  const auto elastic = [&](int i) { return IsElastic(model.parameters[i].kind); };
  if (std::any_of(free.begin(), free.end(), elastic)) return true;
  for (int i = 0; i < model.parameter_count(); ++i) {
    if (elastic(i) && delta[i] != 0.0) return true;
  }
  return false;
}

FitResiduals::FitResiduals(const FitProblem& problem, const Selection& selection,
                           const std::vector<int>& free, const Fit& fit)
    : prior(WidenedPrior(problem, fit)),
      noise(fit.noise),
      placement(fit.placement),
      loads(IsElasticFit(problem.model, free, fit.delta)
                ? ComputeLoads(problem.model, problem.recording, fit.delta, fit.placement,
                               problem.options.load)
                : std::vector<PostureLoads>()),
      body({problem.model, problem.recording, problem.group, selection.markers, selection.tied,
            loads, prior, noise, problem.options.support_form},
           free, fit.delta, placement) {}

}  // namespace elastocal
