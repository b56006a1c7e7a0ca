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
#include "elastocal/calibration/settled_outliers.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/measurement/thinned_motions.hpp"
#include "elastocal/robot/zero_offset.hpp"

namespace elastocal {
namespace {

constexpr int kFewUpdates = 2;  // updates of the noise when only a start is needed
// Updates of the noise where only waist and markers are estimated. The joints are then wrong, which
// no noise describes, so that the noise would hardly come to rest.
constexpr int kExternalUpdates = 15;
constexpr int kMostMoments = 300;   // of motions, by which waist and markers are estimated first
constexpr int kFewestMoments = 30;  // of them in each group, whose noise they tell
constexpr int kMedianUpdates = 8;   // of the noise at most, once a part has told it
constexpr int kLastUpdates = 3;     // of the noise without outliers

bool IsEstimated(const Parameter& parameter, const RobotTree& tree, ModelKind kind) {
  if (IsExternal(parameter.kind)) return true;
  if (IsElastic(parameter.kind)) return kind == ModelKind::kFull;
  return kind == ModelKind::kGeometric || kind == ModelKind::kFull ||
         (kind == ModelKind::kOffsetsOnly && IsZeroOffset(parameter, tree));
}

/// Parameters that are estimated: all of the kind that are not held, also those that cannot be told
/// from others. Of these, the prior selects the smallest combination that explains the data. Where
/// the waist moves, it has a pose in each posture instead of T0.
std::vector<int> OfKind(const ErrorModel& model, const BaseParameters& base, ModelKind kind,
                        bool waist_moves) {
  std::vector<int> free;
  for (int i = 0; i < model.parameter_count(); ++i) {
    if (std::binary_search(base.held.begin(), base.held.end(), i)) continue;
    const Parameter& parameter = model.parameters[i];
    if (waist_moves && parameter.kind == ParameterKind::kWaistPose) continue;
    if (IsEstimated(parameter, model.tree, kind)) free.push_back(i);
  }
  return free;
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

/// What a part of the recording tells of waist, markers and noise.
struct ToldByPart {
  Eigen::VectorXd delta;
  Noise noise;  ///< by group of the whole recording
  int iterations = 0;
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
    // By medians also where the part has told the noise: squares of all moments would take for
    // noise what is wrong throughout a motion.
    fit = FitParameters(problem, selection, free, fit, Robustness::kMedians,
                        told != nullptr ? kMedianUpdates : updates);
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
/// where it is given, takes the place of step 1.
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
    start.iterations = told->iterations;
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
  const std::vector<int> groups = NoiseGroups(model, recording);
  const std::vector<int> kept = ThinnedMotions(recording, kMostMoments, groups, kFewestMoments);
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
  ToldByPart told{few.delta, {}, few.iterations, !few.noise.motion.empty()};
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
