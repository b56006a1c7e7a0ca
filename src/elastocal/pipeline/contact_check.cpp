// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/contact_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <Eigen/Cholesky>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "elastocal/calibration/posterior.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/observed_corrections.hpp"
#include "elastocal/mistakes/observed_faults.hpp"
#include "elastocal/mistakes/observed_mistakes.hpp"
#include "elastocal/observation/exchanged_sessions.hpp"
#include "elastocal/observation/observation_faults.hpp"
#include "elastocal/observation/observation_residuals.hpp"
#include "elastocal/optim/normal_equations.hpp"
#include "elastocal/pipeline/calibrated_robot.hpp"
#include "elastocal/pipeline/check_json.hpp"
#include "elastocal/pipeline/contact_earlier.hpp"
#include "elastocal/pipeline/contact_figures.hpp"
#include "elastocal/pipeline/contact_json.hpp"
#include "elastocal/pipeline/contact_run.hpp"
#include "elastocal/pipeline/earlier_calibration.hpp"
#include "elastocal/pipeline/leave_out_touches.hpp"
#include "elastocal/tables/json_text.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFewestChecked = 4;

/// Residuals of the observations for a robot with these errors, after all beside the robot is
/// fitted.
std::vector<Eigen::VectorXd> LeftBy(const ContactCheck& run, const Eigen::VectorXd& errors) {
  ObservationFit start = StartFit(run.model, run.observations);
  start.values.robot = errors;
  start.loads = ObservedLoads(run.model, run.observations, errors);
  const ObservationFit fit = FitObservations(run.model, run.observations, start,
                                             {.freedom = {.robot = false}, .robust = true});
  return LeftOf(run.model, run.observations, fit.values);
}

ObservationFigures FiguresOf(const ContactCheck& run, const Eigen::VectorXd& errors) {
  return MakeFigures(run.model, run.observations, LeftBy(run, errors));
}

/// Describes observations that are further off than four times the noise, a sentence each.
std::vector<std::string> FarObservations(const ContactCheck& run, const Spread& noise,
                                         const std::vector<Eigen::VectorXd>& left) {
  constexpr double kFar = 4.0;
  std::vector<std::string> far;
  for (std::size_t i = 0; i < left.size(); ++i) {
    const Observation& of = run.observations.all[i];
    const Instrument& instrument = run.model.instrument(of.instrument);
    const double square = (instrument.Weights(noise) * left[i]).squaredNorm();
    if (square <= kFar * kFar * instrument.size()) continue;
    const PosturePlace& place = run.observations.postures[Size(of.posture)];
    far.push_back(
        Place(run.observations.files[Size(place.file)], place.line) +
        fmt::format("'{}' is further off than four times what the calibration left ({}), and the "
                    "others are not: look at it",
                    instrument.name, LeftInWords(instrument, left[i])));
  }
  return far;
}

Observations WithoutPostures(const Observations& observations, const std::set<int>& postures) {
  std::vector<int> others;
  for (int i = 0; i < observations.posture_count(); ++i) {
    if (!postures.contains(i)) others.push_back(i);
  }
  return SelectPostures(observations, others);
}

/// The posture with the largest residuals of a fit.
int WorstPosture(const ObservedRobot& model, const Observations& observations,
                 const ObservationFit& fit) {
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(observations.posture_count());
  const std::vector<Eigen::VectorXd> left = LeftOf(model, observations, fit.values);
  for (std::size_t i = 0; i < left.size(); ++i) {
    const Observation& of = observations.all[i];
    squares[of.posture] +=
        (model.instrument(of.instrument).Weights(fit.spread) * left[i]).squaredNorm();
  }
  Eigen::Index worst = 0;
  squares.maxCoeff(&worst);
  return static_cast<int>(worst);
}

/// Logarithm of the normal density of x about zero, without the constant that depends only on its
/// size.
double LogNormal(const Eigen::VectorXd& x, const Eigen::MatrixXd& covariance) {
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  const Eigen::MatrixXd L = factor.matrixL();
  return -0.5 * x.dot(factor.solve(x)) - L.diagonal().array().log().sum();
}

/// Search for explanations of a change other than moved joints, for a robot that is as calibrated.
class AlternativeSearch {
 public:
  AlternativeSearch(const ContactCheck& run, const EarlierContacts& earlier,
                    const EarlierEstimate& known, const Project& project,
                    const JointCheckOptions& options)
      : run_(run),
        earlier_(earlier),
        known_(known),
        project_(project),
        options_(options),
        calibrated_(run.model) {
    calibrated_.earlier = known;
    estimate_ = EstimateObserved(calibrated_, run.observations, {});
  }

  /// Outlying observations, or the worst posture, if the other postures say that nothing has
  /// changed.
  struct FewPostures {
    std::string text;       ///< empty: there are none
    bool likelier = false;  ///< more probable to be wrong than joints to have moved
  };
  FewPostures FindFewPostures() const {
    constexpr double kMostOthers = 0.75;  // of the postures
    const Observations& all = run_.observations;
    std::set<int> bad;
    for (const ObservationOutlier& outlier : estimate_.outliers) {
      bad.insert(all.all[Size(outlier.observation)].posture);
    }
    std::string text =
        fmt::format("{}", fmt::join(DescribeOutliers(calibrated_, all, estimate_), ", and "));
    if (bad.empty()) {
      const int worst = WorstPosture(calibrated_, all, estimate_.fit);
      const PosturePlace& place = all.postures[Size(worst)];
      text = Place(all.files[Size(place.file)], place.line) +
             "this posture alone speaks of a change, and the others of none";
      bad = {worst};
    }
    const int left = all.posture_count() - static_cast<int>(bad.size());
    const bool rest_holds = left >= kFewestChecked && left >= kMostOthers * all.posture_count() &&
                            Holds(WithoutPostures(all, bad));
    if (!rest_holds) return {};
    return {text, EvidenceOfWrong(bad) > run_.check.log_evidence};
  }

  /// Describes the faults of the tables that explain the change.
  std::vector<std::string> Faults() const {
    constexpr std::size_t kMostTried = 8;
    std::vector<ObservationFault> faults =
        FindObservationFaults(calibrated_, run_.observations, estimate_.fit);
    if (faults.size() > kMostTried) faults.resize(kMostTried);
    std::vector<std::string> found;
    const Observations& all = run_.observations;
    const std::vector<TouchInTheAir> air = FindTouchesInTheAir(calibrated_, all);
    if (!air.empty()) {
      const Observations without = WithoutTouches(all, air);
      if (without.posture_count() >= kFewestChecked && Holds(without)) {
        found.push_back(DescribeTouchesInTheAir(calibrated_, all, air));
      }
    }
    const std::vector<OtherSession> exchanged = FindExchangedSessions(calibrated_, all);
    if (!exchanged.empty() && Holds(InOtherSessions(exchanged, all))) {
      found.push_back(DescribeOtherSessions(exchanged, all));
    }
    for (const ObservationFault& fault : faults) {
      // Some split of the rows explains errors as small as a moved joint's by chance; from the
      // first row on, it is a joint or a mounting that has moved.
      const bool from = fault.kind == ObservationFaultKind::kJointOffset ||
                        fault.kind == ObservationFaultKind::kJointDrift ||
                        fault.kind == ObservationFaultKind::kMoved;
      if (from && (fault.posture == 0 || run_.explained())) continue;
      const ObservationFault refined = Refined(fault, calibrated_, run_.observations);
      const Observations without = WithoutFault(refined, calibrated_, run_.observations);
      if (without.posture_count() < kFewestChecked || !Holds(without)) continue;
      found.push_back(DescribeWithRemedy(refined, calibrated_, run_.observations));
    }
    return found;
  }

 private:
  /// Natural logarithm of p(all | these postures are wrong) / p(all | nothing has changed). Each
  /// posture is equally likely to be wrong. A wrong observation is off by the largest error of a
  /// calibrated robot (LargestError) or by a half, a quarter or an eighth of it, each equally
  /// likely; any other by its noise and by what the others leave open.
  double EvidenceOfWrong(const std::set<int>& postures) const {
    const Observations& all = run_.observations;
    ObservationFit fit = StartFit(calibrated_, all);
    fit.spread = earlier_.contacts.calibrated.spread;
    for (std::size_t i = 0; i < all.all.size(); ++i) {
      if (postures.contains(all.all[i].posture)) fit.weights[i] = 0.0;
    }
    fit = FitObservations(calibrated_, all, fit, {.estimate_spread = false});
    ObservationResiduals residuals(calibrated_, all, fit.loads, fit.spread, fit.weights, {},
                                   fit.values);
    residuals.Evaluate(residuals.Start(), true);
    const NormalEquations equations(residuals);
    const Eigen::MatrixXd covariance = InverseOfInformation(equations.information());
    constexpr std::array kShares = {1.0, 0.5, 0.25, 0.125};
    std::array<double, kShares.size()> by_share{};
    for (int i = 0; i < all.count(); ++i) {
      if (fit.weights[Size(i)] > 0.0) continue;
      const Instrument& instrument = calibrated_.instrument(all.all[Size(i)].instrument);
      Eigen::VectorXd wrong(instrument.size());
      for (int row = 0; row < instrument.size(); ++row) {
        wrong[row] = LargestError(calibrated_, instrument.rows()[Size(row)].unit);
      }
      const Eigen::MatrixXd wide = instrument.Weights(fit.spread) * wrong.asDiagonal();
      Eigen::MatrixXd right = equations.Explained(i, covariance);
      right.diagonal().array() += 1.0;
      for (std::size_t k = 0; k < kShares.size(); ++k) {
        by_share[k] += LogNormal(residuals.Residual(i),
                                 right + kShares[k] * kShares[k] * wide * wide.transpose()) -
                       LogNormal(residuals.Residual(i), right);
      }
    }
    const double most = *std::ranges::max_element(by_share);
    double mean = 0.0;
    for (const double one : by_share) mean += std::exp(one - most) / kShares.size();
    return most + std::log(mean) -
           static_cast<double>(postures.size()) * std::log(all.posture_count());
  }

  /// Whether the calibrated robot explains these observations of the same day.
  bool Holds(const Observations& observations) const {
    ContactCheck other = run_;
    other.observations = observations;
    other.calibrated =
        FiguresOf(other, ErrorsByName(run_.model.robot, earlier_.stored.joint_errors));
    other.check = OpenJoints(run_.model, known_, observations, project_, options_).check;
    return !other.check.changed() && other.FarRows(other.calibrated).empty();
  }

  const ContactCheck& run_;
  const EarlierContacts& earlier_;
  const EarlierEstimate& known_;
  const Project& project_;
  const JointCheckOptions& options_;
  ObservedRobot calibrated_;  ///< with the earlier calibration as prior
  ObservedEstimate estimate_;
};

}  // namespace

std::vector<std::string> ContactCheck::FarRows(const ObservationFigures& figures) const {
  constexpr double kMore = 4.0, kMatters = 0.02;
  std::vector<std::string> far;
  for (std::size_t i = 0; i < figures.rows.size(); ++i) {
    const RowErrors& row = figures.rows[i];
    if (row.unit == SourceUnit::kNone) continue;
    const double most = std::max(kMore * left_before[i], kMatters * LargestError(model, row.unit));
    if (!(row.rms > most)) continue;
    const ShownUnit unit = ShownUnitOf(row.unit);
    far.push_back(fmt::format("{} of {} off by {:.3g} {}, where the calibration left {:.2g}",
                              row.row, model.instrument(row.instrument).name, unit.factor * row.rms,
                              unit.name, unit.factor * left_before[i]));
  }
  return far;
}

bool ContactCheck::recording_explains() const {
  const bool by_one_joint = check.moved.size() == 1 && check.suspects.empty() && explained();
  return few_postures || (!alternatives.empty() && !by_one_joint);
}

bool ContactCheck::unchanged() const {
  return converged && mistakes.empty() && !check.changed() && explained() &&
         !changed_beyond_telling();
}

ContactCheck CheckContacts(const Project& project, const std::filesystem::path& calibration,
                           const std::vector<std::filesystem::path>& recordings,
                           const CheckOptions& options) {
  const EarlierContacts earlier = ReadEarlierContacts(calibration, project);
  ObservationTables tables = ReadObservationTables(recordings, project, &earlier.contacts.feet);
  ContactCheck run;
  run.calibration_file = earlier.stored.source;
  run.recording = fmt::format("{}", fmt::join(tables.observations.files, ", "));
  run.model = MakeRobotAfterEarlier(earlier, project, tables);
  run.observations = std::move(tables.observations);
  run.warnings = std::move(tables.warnings);
  WarnOfOwnRecording(run.calibration_file, recordings, run.warnings);
  for (const std::string& what : CorrectObservations(options.accept, run.model, run.observations)) {
    run.warnings.push_back("corrected on request: " + what);
  }
  if (run.observations.posture_count() < kFewestChecked) {
    throw InputError(run.recording + ": " + std::to_string(run.observations.posture_count()) +
                     " postures; at least " + std::to_string(kFewestChecked) + " were expected");
  }
  const Eigen::VectorXd nominal = Eigen::VectorXd::Zero(run.model.robot.parameter_count());
  run.uncalibrated = FiguresOf(run, nominal);
  const std::vector<Eigen::VectorXd> left =
      LeftBy(run, ErrorsByName(run.model.robot, earlier.stored.joint_errors));
  run.calibrated = MakeFigures(run.model, run.observations, left);
  for (const RowErrors& row : run.calibrated.rows) {
    run.left_before.push_back(NoiseOf(run.model, row, earlier.contacts.calibrated.spread));
  }
  if (!LargeErrors(run.model, run.calibrated).empty()) {
    run.mistakes = FindObservedMistakes(run.model, run.observations);
  }

  const EarlierEstimate known = MakeEarlierOfContacts(earlier, run.model, project, options.days);
  OpenedRobot opened = OpenJoints(run.model, known, run.observations, project, options.joints);
  run.check = std::move(opened.check);
  std::ranges::move(DescribeWidened(run.check, run.calibration_file),
                    std::back_inserter(run.warnings));
  run.converged = opened.estimate.fit.termination == Termination::kConverged;
  run.updated = MakeFigures(run.model, run.observations,
                            LeftOf(run.model, run.observations, opened.estimate.fit.values));
  if (run.unchanged()) {
    for (std::string& text : FarObservations(run, earlier.contacts.calibrated.spread, left)) {
      run.warnings.push_back(std::move(text));
    }
  } else if (run.mistakes.empty()) {
    const AlternativeSearch search(run, earlier, known, project, options.joints);
    const AlternativeSearch::FewPostures few = search.FindFewPostures();
    run.alternatives = search.Faults();
    run.few_postures = few.likelier;
    if (few.likelier) {
      run.alternatives.insert(run.alternatives.begin(), few.text);
    } else if (!few.text.empty()) {
      run.warnings.push_back(few.text + ": measure it again");
    }
  }
  for (std::string& text : DescribeOutliers(run.model, run.observations, opened.estimate)) {
    run.warnings.push_back(std::move(text));
  }
  return run;
}

std::string CheckStatus(const ContactCheck& run) {
  if (!run.mistakes.empty() || run.recording_explains()) return "recording wrong";
  if (!run.converged) return "not converged";
  if (!run.explained()) return "unexplained";
  if (!run.check.moved.empty()) return "moved";
  return run.unchanged() ? "unchanged" : "changed";
}

std::string MakeCheckJson(const ContactCheck& run) {
  Json json;
  json["status"] = CheckStatus(run);
  json["calibration"] = run.calibration_file;
  json["recording"] = run.recording;
  json["postures"] = run.observations.posture_count();
  json["contact"] = FiguresJson(run.model, run.calibrated);
  json["contact"]["uncalibrated"] = FiguresJson(run.model, run.uncalibrated);
  json["contact"]["updated"] = FiguresJson(run.model, run.updated);
  AddJointCheck(run.check, json);
  json["mistakes"] = run.mistakes;
  json["alternatives"] = run.alternatives;
  json["warnings"] = run.warnings;
  return JsonText(json);
}

}  // namespace elastocal
