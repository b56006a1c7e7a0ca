// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/calibrate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "elastocal/calibration/fit.hpp"
#include "elastocal/calibration/registration.hpp"
#include "elastocal/calibration/residuals.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/measurement/thinned_motions.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kMaxVerdicts = 5;
constexpr int kFewUpdates = 2;  // updates of the noise when only a start is needed
// Updates of the noise where only waist and markers are estimated. The joints are then wrong, which
// no noise describes, so that the noise would hardly come to rest.
constexpr int kExternalUpdates = 15;
constexpr int kMostMoments = 300;  // of motions, by which waist and markers are estimated first
constexpr int kLastUpdates = 3;    // of the noise, once a part of the moments has told it

bool IsEstimated(ParameterKind parameter, ModelKind kind) {
  if (IsExternal(parameter)) return true;
  if (IsElastic(parameter)) return kind == ModelKind::kFull;
  return kind == ModelKind::kGeometric || kind == ModelKind::kFull ||
         (kind == ModelKind::kOffsetsOnly &&
          (parameter == ParameterKind::kTheta || parameter == ParameterKind::kMotorZero));
}

/// Parameters that are estimated: all of the kind that are not held, also those that cannot be told
/// from others. Of these, the prior selects the smallest combination that explains the data. Where
/// the waist moves, it has a pose in each posture instead of T0.
std::vector<int> OfKind(const ErrorModel& model, const BaseParameters& base, ModelKind kind,
                        bool waist_moves) {
  std::vector<int> free;
  for (int i = 0; i < model.parameter_count(); ++i) {
    if (std::binary_search(base.held.begin(), base.held.end(), i)) continue;
    const ParameterKind parameter = model.parameters[i].kind;
    if (waist_moves && parameter == ParameterKind::kWaistPose) continue;
    if (IsEstimated(parameter, kind)) free.push_back(i);
  }
  return free;
}

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

struct EquationCount {
  Eigen::Index equations = 0;
  /// Identifiable parameters that no earlier calibration tells, and six for each pose of waist or
  /// footing.
  Eigen::Index unknowns = 0;
  bool enough() const { return equations >= unknowns; }
};

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

/// Refuses a recording with fewer equations than identifiable unknowns, unless an earlier
/// calibration tells them. (With the prior, any number of equations has a solution.)
void CheckEquations(const FitProblem& problem, const Placement& placement,
                    const Selection& selection, const BaseParameters& base,
                    const std::vector<int>& free) {
  const Recording& recording = problem.recording;
  const EquationCount count = CountEquations(problem, placement, selection, base, free);
  if (count.enough()) return;
  throw InputError(recording.source + ": " + std::to_string(count.equations) + " equations (" +
                   std::to_string(recording.posture_count()) + " postures, " +
                   std::to_string(recording.marker_count()) + " markers) for " +
                   std::to_string(count.unknowns) +
                   (placement.empty() ? " parameters" : " parameters and poses of the waist") +
                   "; record more postures or hold parameters");
}

void FillStatus(const BaseParameters& base, const CalibrationOptions& options,
                const Posterior& posterior, CalibrationResult& result) {
  result.status.assign(result.model.parameters.size(), ParameterStatus::kNotInModel);
  for (int i : base.held) result.status[i] = ParameterStatus::kHeld;
  Prior prior = options.prior;
  prior.scale = result.prior_scale;
  result.prior_sd.setConstant(result.model.parameter_count(),
                              std::numeric_limits<double>::quiet_NaN());
  for (int i : posterior.parameters) {
    result.prior_sd[i] = prior.Of(result.model.tree, result.model.parameters[i]);
    const bool told = result.sd[i] < options.support_threshold * result.prior_sd[i];
    result.status[i] = told ? ParameterStatus::kEstimated : ParameterStatus::kUnsupported;
  }
}

/// Root mean square, over the used observations, of the groups' standard deviations.
double PooledMarkerSd(const ObservationMask& used, const std::vector<int>& group,
                      const Noise& noise) {
  double squares = 0.0;
  double count = 0.0;
  for (Eigen::Index i = 0; i < used.rows(); ++i) {
    const int g = group[static_cast<std::size_t>(i)];
    const auto seen = static_cast<double>(used.row(i).count());
    squares += seen * (noise.Variance(g, NoiseSource::kMarker) +
                       noise.Variance(g, NoiseSource::kBodyPosition));
    count += seen;
  }
  return std::sqrt(squares / std::max(1.0, count));
}

void FillResult(const BaseParameters& base, const CalibrationOptions& options, Fit fit,
                CalibrationResult& result) {
  result.equations = static_cast<int>(3 * result.used.count());
  result.marker_sd = PooledMarkerSd(result.used, result.group, fit.noise);
  result.noise = fit.noise;
  result.placement = fit.placement;
  result.prior_scale = fit.prior_scale;
  result.interval_factor = StudentQuantile(0.975, fit.degrees_of_freedom);
  result.correlations = StrongCorrelations(fit.posterior, options.correlation_threshold);
  result.sd.setConstant(result.model.parameter_count(), std::numeric_limits<double>::quiet_NaN());
  result.sd(fit.posterior.parameters) = fit.posterior.StandardDeviations();
  result.settled = fit.settled;
  result.termination = fit.termination;
  result.message = fit.message;
  result.iterations = fit.iterations;
  result.initial_cost = fit.initial_cost;
  result.final_cost = fit.final_cost;
  result.delta = std::move(fit.delta);
  FillStatus(base, options, fit.posterior, result);
  result.posterior = std::move(fit.posterior);
}

/// Judges outliers with the noise of single moments: correlations within motions are ignored.
OutlierVerdict JudgeOutliers(const FitProblem& problem, const Selection& selection,
                             const std::vector<int>& free, Fit fit) {
  fit.noise.motion.clear();
  return FindOutliers(problem, selection, free, fit, problem.options.outlier_probability);
}

/// Fits without the outliers of a verdict and judges anew, until the verdict no longer changes. An
/// observation at the limit may be left out and taken back in turns; it then stays out. Where too
/// few equations would be left, all observations are kept: so many cannot all be outliers, and the
/// true cause is not known yet.
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

/// What a part of the recording tells of waist, markers and noise.
struct ToldByPart {
  Eigen::VectorXd delta;
  Noise noise;  ///< by group of the whole recording
  bool settled = true;
  bool correlated = false;  ///< errors in motions, as far as they came to rest
};

/// Steps 2 and 3 of Calibrate, starting from a fit of waist and markers. `told` has the noise
/// already, where it is given.
void EstimateAll(const FitProblem& problem, const BaseParameters& base,
                 const std::vector<int>& free, const Selection* fixed, const ToldByPart* told,
                 Fit fit, CalibrationResult& result) {
  const Recording& recording = problem.recording;
  Selection selection = fixed != nullptr ? *fixed : SelectAll(problem.model, recording);
  OutlierVerdict verdict;
  CheckEquations(problem, fit.placement, selection, base, free);
  const bool joints = result.kind != ModelKind::kUncalibrated;
  const int updates = told != nullptr              ? kLastUpdates
                      : joints || fixed == nullptr ? kMaxUpdates
                                                   : kExternalUpdates;
  if (fixed != nullptr) {
    fit = FitParameters(problem, selection, free, fit, Robustness::kMoments, updates);
  } else {
    fit = FitParameters(problem, selection, free, fit,
                        told != nullptr ? Robustness::kMoments : Robustness::kMedians, updates);
    verdict = JudgeOutliers(problem, selection, free, fit);
    verdict = SettleOutliers(problem, base, free, updates, std::move(verdict), selection, fit,
                             result.too_many_outliers);
  }
  if (told != nullptr && told->correlated) CorrelateMotions(problem, selection, free, fit);
  Polish(problem, selection, free, fit);
  UpdatePosterior(problem, selection, free, fit);
  result.outliers = std::move(verdict.markers);
  result.loose_footings = std::move(verdict.footings);
  result.short_models = FindShortModels(problem, selection, fit);
  result.used = std::move(selection.markers);
  result.tied = std::move(selection.tied);
  if (!fit.placement.empty() && result.kind == ModelKind::kFull) {
    ComputeLoads(problem.model, recording, fit.delta, fit.placement, problem.options.load,
                 &result.loads);
  }
  FillResult(base, problem.options, std::move(fit), result);
}

/// All steps of Calibrate. Parameters that are not estimated keep their value in `delta`. `told`,
/// where it is given, takes the place of step 1 and of the medians.
void Estimate(const ErrorModel& model, const Recording& recording, const BaseParameters& base,
              const CalibrationOptions& options, const Selection* fixed,
              const Eigen::VectorXd& delta, const ToldByPart* told, CalibrationResult& result) {
  result.model = model;
  const bool waist_moves = HasPoseByPosture(recording);
  // T0 starts at zero.
  if (!waist_moves) result.model.T_ref_waist = RegisterWaist(model, recording);
  result.group = NoiseGroups(model, recording);
  const FitProblem problem{result.model, recording, options, result.group};
  const Selection selection = fixed != nullptr ? *fixed : SelectAll(model, recording);
  const std::vector<int> externals = OfKind(model, base, ModelKind::kUncalibrated, waist_moves);
  Fit start = StartFit(problem, selection, told != nullptr ? told->delta : delta);
  if (waist_moves) FindFootings(model, recording, options.slip, &result.slips);
  CheckEquations(problem, start.placement, selection, base, externals);
  const std::vector<int> free = OfKind(model, base, result.kind, waist_moves);
  if (told != nullptr) {
    start.noise = told->noise;
    start.settled = told->settled;
    EstimateAll(problem, base, free, fixed, told, start, result);
    return;
  }
  const Fit fit =
      FitParameters(problem, selection, externals, start,
                    fixed == nullptr ? Robustness::kMedians : Robustness::kMoments, kFewUpdates);
  EstimateAll(problem, base, free, fixed, nullptr, fit, result);
}

/// What the part of a recording with fewer moments of motions tells of waist and markers: most of
/// them tell hardly more. None where the part is not much smaller, or has no posture of some group.
std::optional<ToldByPart> TellByFewMoments(const ErrorModel& model, const Recording& recording,
                                           const BaseParameters& base,
                                           const CalibrationOptions& options,
                                           const Selection* fixed, const Eigen::VectorXd& delta) {
  if (recording.trials.empty() || !HasPoseByPosture(recording)) return std::nullopt;
  const std::vector<int> kept = ThinnedMotions(recording, kMostMoments);
  if (2 * std::ssize(kept) > recording.posture_count()) return std::nullopt;
  const Recording part = SelectPostures(recording, kept);
  std::optional<Selection> of_part;
  if (fixed != nullptr) {
    std::vector<char> tied;
    for (const int i : kept) tied.push_back(fixed->tied[Size(i)]);
    of_part = Select(model, part, fixed->markers(kept, Eigen::all), std::move(tied));
  }
  CalibrationResult few;
  few.kind = ModelKind::kUncalibrated;
  try {
    Estimate(model, part, base, options, of_part ? &*of_part : nullptr, delta, nullptr, few);
  } catch (const InputError&) {  // too few equations
    return std::nullopt;
  }
  const std::vector<int> groups = NoiseGroups(model, recording);
  ToldByPart told{few.delta, {}, few.settled, !few.noise.motion.empty()};
  told.noise.sd.setConstant(1 + *std::ranges::max_element(groups), kNoiseSourceCount, kNaN);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    told.noise.sd.row(groups[Size(kept[k])]) = few.noise.sd.row(few.group[k]);
  }
  if (!told.noise.sd.allFinite()) return std::nullopt;
  return told;
}

template <typename Work>
CalibrationResult Timed(ModelKind kind, Work work) {
  CalibrationResult result;
  result.kind = kind;
  const auto start = std::chrono::steady_clock::now();
  work(result);
  result.solve_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace

CalibrationResult Calibrate(const ErrorModel& model, const Recording& recording,
                            const BaseParameters& base, ModelKind kind,
                            const CalibrationOptions& options, const Selection* fixed) {
  return Timed(kind, [&](CalibrationResult& result) {
    const Eigen::VectorXd nominal = Eigen::VectorXd::Zero(model.parameter_count());
    Estimate(model, recording, base, options, fixed, nominal, nullptr, result);
  });
}

CalibrationResult RefitExternals(const ErrorModel& model, const Recording& recording,
                                 const BaseParameters& base, const CalibrationOptions& options,
                                 const std::map<std::string, double>& joint_errors,
                                 const Selection* fixed) {
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
  for (int i = 0; i < model.parameter_count(); ++i) {
    const Parameter& parameter = model.parameters[i];
    const auto error = joint_errors.find(parameter.name);
    if (!IsExternal(parameter.kind) && error != joint_errors.end()) delta[i] = error->second;
  }
  return Timed(ModelKind::kUncalibrated, [&](CalibrationResult& result) {
    const auto told = TellByFewMoments(model, recording, base, options, fixed, delta);
    Estimate(model, recording, base, options, fixed, delta, told ? &*told : nullptr, result);
  });
}

CalibrationResult WithoutSprings(const CalibrationResult& full, const ErrorModel& model,
                                 const Recording& recording, const BaseParameters& base,
                                 const CalibrationOptions& options, const Selection& fixed) {
  std::map<std::string, double> geometry;
  for (int i = 0; i < full.model.parameter_count(); ++i) {
    const Parameter& parameter = full.model.parameters[i];
    if (!IsElastic(parameter.kind)) geometry[parameter.name] = full.delta[i];
  }
  CalibrationResult rigid = RefitExternals(model, recording, base, options, geometry, &fixed);
  rigid.kind = ModelKind::kRigid;
  return rigid;
}

}  // namespace elastocal
