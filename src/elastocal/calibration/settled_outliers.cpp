// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/settled_outliers.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "elastocal/calibration/earlier.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kMaxVerdicts = 5;

Selection Without(const ErrorModel& model, const Recording& recording,
                  const OutlierVerdict& verdict) {
  ObservationMask markers = SeenMask(recording);
  std::vector<char> tied(static_cast<std::size_t>(recording.posture_count()), 1);
  for (const Outlier& outlier : verdict.markers) markers(outlier.posture, outlier.marker) = false;
  for (const LooseFooting& footing : verdict.footings) tied[footing.posture] = 0;
  return Select(model, recording, std::move(markers), std::move(tied));
}

/// Transfers weights to another selection, by posture and body. A body that took no part before has
/// weight 1.
RobustWeights WeightsIn(const Selection& after, const Selection& before,
                        const RobustWeights& weights) {
  if (weights.bodies.size() != before.bodies.size()) return {};
  std::map<std::pair<int, int>, Weight> of;  // by posture and body
  for (std::size_t b = 0; b < before.bodies.size(); ++b) {
    const BodyObservation& body = before.bodies[b];
    if (body.used) of.emplace(std::pair(body.posture, body.body), weights.bodies[b]);
  }
  RobustWeights result{{}, weights.ties};
  for (const BodyObservation& body : after.bodies) {
    const auto found = of.find({body.posture, body.body});
    result.bodies.push_back(body.used && found != of.end() ? found->second : Weight());
  }
  return result;
}

bool Same(const OutlierVerdict& a, const OutlierVerdict& b) {
  return std::equal(a.markers.begin(), a.markers.end(), b.markers.begin(), b.markers.end(),
                    [](const Outlier& x, const Outlier& y) {
                      return x.posture == y.posture && x.marker == y.marker;
                    }) &&
         std::equal(
             a.footings.begin(), a.footings.end(), b.footings.begin(), b.footings.end(),
             [](const LooseFooting& x, const LooseFooting& y) { return x.posture == y.posture; });
}

/// Adds to `into` the outliers and loose footings that only `others` names.
void Join(OutlierVerdict& into, const OutlierVerdict& others) {
  const auto add = [](auto& to, const auto& from, const auto& place) {
    for (const auto& found : from) {
      const auto at =
          std::lower_bound(to.begin(), to.end(), found,
                           [&](const auto& a, const auto& b) { return place(a) < place(b); });
      if (at == to.end() || place(found) < place(*at)) to.insert(at, found);
    }
  };
  add(into.markers, others.markers,
      [](const Outlier& at) { return std::pair(at.posture, at.marker); });
  add(into.footings, others.footings, [](const LooseFooting& at) { return at.posture; });
}

}  // namespace

EquationCount CountEquations(const FitProblem& problem, const Placement& placement,
                             const Selection& selection, const BaseParameters& base,
                             const std::vector<int>& free) {
  const EarlierPart earlier = PartOf(problem.options.earlier, problem.model, free);
  EquationCount count{.equations = 3 * selection.markers.count()};
  const Eigen::Index identifiable = std::count_if(free.begin(), free.end(), [&](int i) {
    return std::binary_search(base.kept.begin(), base.kept.end(), i);
  });
  count.unknowns =
      std::max<Eigen::Index>(0, identifiable - static_cast<Eigen::Index>(earlier.positions.size()));
  for (int i = 0; i < static_cast<int>(placement.T_ref_waist.size()); ++i) {
    count.unknowns += 6;
    if (placement.footing[i] >= 0 && selection.tied[i] != 0) count.equations += 6;
  }
  count.unknowns += 6 * static_cast<Eigen::Index>(placement.footings.size());
  return count;
}

OutlierVerdict JudgeOutliers(const FitProblem& problem, const Selection& selection,
                             const std::vector<int>& free, Fit fit) {
  fit.noise.motion.clear();
  return FindOutliers(problem, selection, free, fit, problem.options.outlier_probability);
}

OutlierVerdict SettleOutliers(const FitProblem& problem, const BaseParameters& base,
                              const std::vector<int>& free, int updates, OutlierVerdict verdict,
                              Selection& selection, Fit& fit, bool& too_many) {
  const auto fit_to = [&](const OutlierVerdict& without) {
    if (problem.options.outliers == OutlierPolicy::kRemove) {
      Selection next = Without(problem.model, problem.recording, without);
      too_many = !CountEquations(problem, fit.placement, next, base, free).enough();
      if (too_many) next = SelectAll(problem.model, problem.recording);
      fit.weights = WeightsIn(next, selection, fit.weights);
      selection = std::move(next);
    }
    fit = FitParameters(problem, selection, free, fit, Robustness::kMoments, updates);
  };
  std::vector<OutlierVerdict> earlier;
  for (;;) {
    fit_to(verdict);
    if (too_many) return verdict;
    OutlierVerdict next = JudgeOutliers(problem, selection, free, fit);
    if (problem.options.outliers == OutlierPolicy::kKeep || Same(next, verdict)) return next;
    if (earlier.size() == kMaxVerdicts) {
      fit.settled = false;
      return verdict;  // the verdict with which the fit was made
    }
    if (std::any_of(earlier.begin(), earlier.end(),
                    [&](const OutlierVerdict& before) { return Same(next, before); })) {
      Join(next, verdict);
      fit_to(next);
      return next;
    }
    earlier.push_back(std::move(verdict));
    verdict = std::move(next);
  }
}

}  // namespace elastocal
