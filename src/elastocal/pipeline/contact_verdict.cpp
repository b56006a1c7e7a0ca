// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/contact_verdict.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/mistakes/observed_conventions.hpp"
#include "elastocal/mistakes/observed_faults.hpp"
#include "elastocal/mistakes/observed_mistakes.hpp"
#include "elastocal/pipeline/choose_causes.hpp"
#include "elastocal/pipeline/contact_figures.hpp"
#include "elastocal/pipeline/contact_json.hpp"
#include "elastocal/pipeline/contact_remarks.hpp"

namespace elastocal {
namespace {

constexpr double kPlainGain = 2.0;  // standard deviations from which a gain is not due to chance
// Ratio to the error before above which hardly anything was gained.
constexpr double kLittleBetter = 0.95;
constexpr double kMostLeftOut = 0.25;  // share of observations
constexpr double kNoRobot = 10.0;      // times the expected errors, as for tables of markers

/// The smallest ratio, over all kinds of rows, of the error after calibration to that before.
double BestRatio(const ContactRun& run) {
  const std::vector<RowErrors>& before = ContactRun::Judged(run.uncalibrated).rows;
  const std::vector<RowErrors>& after = ContactRun::Judged(run.calibrated).rows;
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < after.size(); ++i) {
    best = std::min(best, after[i].rms / std::max(before[i].rms, 1e-300));
  }
  return best;
}

/// Kinds of errors of the robot that exceed ten times the expected ones.
std::vector<std::string> WidePriors(const ContactRun& run) {
  std::vector<std::string> wide;
  const std::vector<Source> sources = CommonSources();
  const ObservationFit& fit = run.calibrated.estimate.fit;
  const std::pair<CommonSource, const char*> kinds[] = {{kLegOffset, "zero offsets of legs"},
                                                        {kTrunkOffset, "zero offsets of the trunk"},
                                                        {kLimbOffset, "zero offsets"},
                                                        {kLength, "lengths"},
                                                        {kAngle, "angles of axes"}};
  for (const auto& [source, what] : kinds) {
    if (fit.spread[source] > kNoRobot * sources[static_cast<std::size_t>(source)].sd) {
      const ShownUnit unit = ShownUnitOf(sources[static_cast<std::size_t>(source)].unit);
      wide.push_back(
          fmt::format("{} of {:.3g} {}", what, unit.factor * fit.spread[source], unit.name));
    }
  }
  return wide;
}

const char* ThingsOf(const ContactRun& run) {
  return run.touches_only() ? "touches" : "observations";
}

/// Adds the errors of the URDF alone, which has neither springs nor causes, beside those of the
/// whole model.
void AddUrdfAlone(ContactRun& run, const std::string& on) {
  run.verdict.remarks.push_back(
      fmt::format("these figures hold with {}; the URDF alone leaves {} {}", CompensationOf(run),
                  FiguresInWords(run, ContactRun::Judged(*run.geometric)), on));
}

/// The causes were chosen by all postures. Adds what is honest of a choice that has not seen a
/// posture.
void AddWithoutCauses(ContactRun& run, const std::string& on) {
  const CauseSearch& search = run.causes->search;
  run.verdict.remarks.push_back(
      fmt::format("causes beyond geometry and springs were chosen by all {}, which flatters these "
                  "figures: without them the robot leaves {} {}, and causes that were chosen "
                  "without a posture take its error from {:.3f} to {:.3f} standard deviations of "
                  "noise",
                  ThingsOf(run), FiguresInWords(run, *run.without_causes), on, search.error,
                  search.nested_error));
}

/// Ratio of a tag's size in the left-out images to its size in the project; 1 for what is no tag.
double SizeInImages(const ContactRun& run, const std::vector<ObservationOutlier>& left_out) {
  std::vector<double> ratios;
  for (const ObservationOutlier& one : left_out) {
    const Eigen::VectorXd& seen = run.observations.all[Size(one.observation)].measured;
    if (seen.size() != 8) return 1.0;
    const auto around = [](const Eigen::VectorXd& corners) {
      double length = 0.0;
      for (Eigen::Index i = 0; i < 4; ++i) {
        length += (corners.segment<2>(2 * i) - corners.segment<2>(2 * ((i + 1) % 4))).norm();
      }
      return length;
    };
    ratios.push_back(around(seen) / around(seen + one.left));
  }
  return Median(ratios);
}

/// Instruments, of which there are several alike, most of whose observations were left out, and a
/// larger share than of any other: a sentence each. Such an instrument is wrong as a whole.
std::vector<std::string> WrongAsAWhole(const ContactRun& run) {
  constexpr double kMost = 0.6;
  constexpr std::size_t kFewest = 4;
  constexpr double kOtherSize = 1.1;
  std::vector<std::string> texts;
  double largest = kMost;
  for (const MeasuredBy& of : SeveralAlike(run.model, run.observations)) {
    std::vector<ObservationOutlier> left_out;
    for (const ObservationOutlier& outlier : run.calibrated.estimate.outliers) {
      if (IsMeasuredBy(run.model, run.observations.all[Size(outlier.observation)], of)) {
        left_out.push_back(outlier);
      }
    }
    const auto all =
        std::count_if(run.observations.all.begin(), run.observations.all.end(),
                      [&](const Observation& one) { return IsMeasuredBy(run.model, one, of); });
    const double share = static_cast<double>(left_out.size()) / static_cast<double>(all);
    if (left_out.size() < kFewest || share < largest) continue;
    if (share > largest) texts.clear();
    largest = share;
    std::string text = fmt::format(
        "{} of {} observations of {} '{}' contradict the others and are left out: is it where the "
        "project has it, and in the right unit?",
        left_out.size(), all, of.kind, of.name);
    const double ratio = of.kind == "tag" ? SizeInImages(run, left_out) : 1.0;
    if (std::max(ratio, 1.0 / ratio) > kOtherSize) {
      text +=
          fmt::format(" In its images it is about {:.2g} times as large as size_mm says", ratio);
    }
    texts.push_back(text);
  }
  return texts;
}

/// Adds one objection for errors that no robot has, if there are any.
void ObjectToNonsense(ContactRun& run) {
  std::vector<std::string> nonsense = WidePriors(run);
  for (std::string& text : LargeErrors(run.model, FiguresOfGood(run))) {
    nonsense.push_back(std::move(text));
  }
  if (nonsense.empty()) return;
  run.verdict.objections.push_back(fmt::format(
      "no robot has errors like these: {}. Check the order, signs and units of the columns, which "
      "row belongs to which, and how instruments and what they look at are mounted",
      fmt::join(nonsense, "; ")));
}

/// Puts an objection before the others that names the mistakes in the tables. Returns whether there
/// are any.
bool NameMistakes(ContactRun& run) {
  if (!run.mistakes) run.mistakes = FindObservedMistakes(run.model, run.observations);
  if (run.mistakes->empty()) return false;
  run.verdict.objections.insert(
      run.verdict.objections.begin(),
      fmt::format(
          "{}; without that, even the uncalibrated robot, mounted as the project says, errs by "
          "less than a third",
          fmt::join(*run.mistakes, "; or ")));
  return true;
}

}  // namespace

std::string CompensationOf(const ContactRun& run) {
  const std::vector<Parameter>& parameters = run.model.robot.parameters;
  const bool springs = std::any_of(parameters.begin(), parameters.end(),
                                   [](const Parameter& of) { return IsCompliance(of.kind); });
  return CompensationInWords(springs, run.extra);
}

namespace {

/// Judges whether the fit explains its own data.
void JudgeFit(ContactRun& run) {
  Verdict& verdict = run.verdict;
  if (run.calibrated.estimate.fit.termination != Termination::kConverged) {
    verdict.objections.emplace_back(
        "the estimate has not converged: variances did not come to rest");
  }
  if (!run.wrong_rows.empty()) verdict.objections.push_back(run.wrong_rows);
  const auto left_out = static_cast<double>(run.calibrated.estimate.outliers.size());
  if (left_out > kMostLeftOut * run.observations.count()) {
    verdict.objections.push_back(fmt::format("{:.0f} of {} {} are outliers", left_out,
                                             run.observations.count(), ThingsOf(run)));
  }
}

/// Judges whether the calibrated robot is better than the nominal one; `on` names the data.
void JudgeGain(const std::string& on, ContactRun& run) {
  Verdict& verdict = run.verdict;
  const double ratio = BestRatio(run);
  if (!(ratio < 1.0) || run.gain_in_sds < -kPlainGain) {
    verdict.objections.push_back("the calibrated robot is no better than the uncalibrated one " +
                                 on);
  } else if (run.gain_in_sds < kPlainGain || ratio > kLittleBetter) {
    verdict.remarks.push_back("the calibrated robot is hardly better than the uncalibrated one " +
                              on);
  }
  const std::vector<std::string> worse = WorseRows(run.model, ContactRun::Judged(run.uncalibrated),
                                                   ContactRun::Judged(run.calibrated));
  if (!worse.empty()) {
    verdict.objections.push_back(
        fmt::format("the calibrated robot is worse {}: {}", on, fmt::join(worse, "; ")));
  }
}

/// Puts the faults of the tables before the objections that follow from them.
void NameFaults(bool mistaken, ContactRun& run) {
  Verdict& verdict = run.verdict;
  if ((verdict.objections.empty() && !mistaken) || !NameMistakes(run)) {
    const std::string fault =
        FindObservedFault(run.model, run.observations, run.calibrated.estimate.fit);
    if (!fault.empty()) verdict.objections.insert(verdict.objections.begin(), fault);
  }
  const std::vector<std::string> wrong = WrongAsAWhole(run);
  std::vector<std::string>& said =
      verdict.objections.empty() ? verdict.remarks : verdict.objections;
  said.insert(said.begin(), wrong.begin(), wrong.end());
}

}  // namespace

void JudgeContacts(ContactRun& run) {
  Verdict& verdict = run.verdict;
  const bool held_out = run.calibrated.held_out.folds > 0;
  const std::string what = ThingsOf(run);
  const std::string on =
      held_out ? "on " + what + " that were left out" : "on the " + what + " of the fit";
  JudgeFit(run);
  JudgeGain(on, run);
  ObjectToNonsense(run);
  const bool mistaken = run.mistakes && !run.mistakes->empty();
  NameFaults(mistaken, run);
  if (verdict.objections.empty()) RemarkOnNoise(run);
  RemarkOnCovariances(run);
  if (verdict.objections.empty()) RemarkOnMountings(run);
  if (!held_out && !mistaken) {
    verdict.remarks.push_back("no " + std::string(run.touches_only() ? "touch" : "posture") +
                              " was left out (--kfold 0): nothing was validated");
  }
  if (run.geometric) AddUrdfAlone(run, on);
  if (held_out && run.without_causes) AddWithoutCauses(run, on);
  if (run.calibrated.held_out.unsettled > 0) {
    verdict.remarks.push_back(fmt::format("{} of {} folds have not converged",
                                          run.calibrated.held_out.unsettled,
                                          run.calibrated.held_out.folds));
  }
  if (run.model.setup.feet.size() > 1) verdict.remarks.push_back(DescribeClosure(run.closure));
}

}  // namespace elastocal
