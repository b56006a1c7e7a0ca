// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/contact_verdict.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "elastocal/calibration/posterior.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/mistakes/observed_conventions.hpp"
#include "elastocal/mistakes/observed_faults.hpp"
#include "elastocal/mistakes/observed_mistakes.hpp"
#include "elastocal/observation/observed_posture.hpp"
#include "elastocal/pipeline/choose_causes.hpp"
#include "elastocal/pipeline/contact_json.hpp"

namespace elastocal {
namespace {

constexpr double kPlainGain = 2.0;      // standard deviations: better by no chance
constexpr double kLittleBetter = 0.95;  // of the error before: hardly anything was gained
constexpr double kMuchNoise = 4.0;      // times what the project says
constexpr double kClearlyWorse = 1.25;  // of the error before
constexpr double kMostLeftOut = 0.25;   // share of observations
constexpr double kDegreeHere = 180.0 / M_PI;
constexpr double kMatters = 0.1;   // of LargestError: below, it may be noise
constexpr double kNoRobot = 10.0;  // times what is expected, as of tables of markers

/// The least error of any kind of row after calibration, over that before.
double BestRatio(const ContactRun& run) {
  const std::vector<RowErrors>& before = ContactRun::Judged(run.uncalibrated).rows;
  const std::vector<RowErrors>& after = ContactRun::Judged(run.calibrated).rows;
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < after.size(); ++i) {
    best = std::min(best, after[i].rms / std::max(before[i].rms, 1e-300));
  }
  return best;
}

/// "position of lt"
std::string RowName(const ObservedRobot& model, const RowErrors& row) {
  return row.row + " of " + model.instrument(row.instrument).name;
}

std::string FigureOf(const RowErrors& row) {
  return fmt::format("{:.3g}", ShownUnitOf(row.unit).factor * row.rms);
}

/// Kinds of errors of the robot that are more than ten times what is expected of one.
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

/// Errors on what was judged, without what was found to be wrong and left out.
ObservationFigures FiguresOfGood(const ContactRun& run) {
  const ContactOutcome& outcome = run.calibrated;
  std::set<int> bad;
  for (const ObservationOutlier& outlier : outcome.estimate.outliers) {
    bad.insert(outlier.observation);
  }
  const std::vector<Eigen::VectorXd> left =
      outcome.held_out.folds > 0 ? outcome.held_out.left
                                 : LeftOf(run.model, run.observations, outcome.estimate.fit.values);
  Observations good = run.observations;
  good.all.clear();
  std::vector<Eigen::VectorXd> left_of_good;
  for (int i = 0; i < run.observations.count(); ++i) {
    if (bad.contains(i)) continue;
    good.all.push_back(run.observations.all[static_cast<std::size_t>(i)]);
    left_of_good.push_back(left[static_cast<std::size_t>(i)]);
  }
  return MakeFigures(run.model, good, left_of_good);
}

/// "0.04 mm in position of lt, 0.02 degrees in rotation of lt"; of touches their height and tilt.
std::string FiguresInWords(const ContactRun& run, const ObservationFigures& figures) {
  if (run.touches_only()) {
    return fmt::format("{:.2f} mm and {:.2f} degrees", 1e3 * figures.all.height,
                       kDegreeHere * figures.all.tilt());
  }
  std::vector<std::string> texts;
  for (const RowErrors& row : figures.rows) {
    texts.push_back(fmt::format("{} {} in {}", FigureOf(row), ShownUnitOf(row.unit).name,
                                RowName(run.model, row)));
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

/// The file that is deployed has neither springs nor causes: its figures beside those of the whole
/// model.
void AddUrdfAlone(ContactRun& run, const std::string& on) {
  run.verdict.remarks.push_back(
      fmt::format("these figures hold with {}; the URDF alone leaves {} {}", CompensationOf(run),
                  FiguresInWords(run, ContactRun::Judged(*run.geometric)), on));
}

/// Noise that is far above what the project says of an instrument is no noise of it.
void RemarkOnNoise(ContactRun& run) {
  const std::vector<Source>& sources = run.model.setup.sources;
  const ObservationFit& fit = run.calibrated.estimate.fit;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (sources[i].role != Source::Role::kNoise) continue;
    const double ratio = fit.spread.sd[i] / sources[i].sd;
    if (ratio < kMuchNoise) continue;
    const ShownUnit unit = ShownUnitOf(sources[i].unit);
    run.verdict.remarks.push_back(fmt::format(
        "the noise of {} is {:.2g} {}, {:.2g} times what was expected: a joint that was off for a "
        "part of the recording, gears, or something that was moved? summary.json has what is left "
        "of each row",
        sources[i].name, unit.factor * fit.spread.sd[i], unit.name, ratio));
  }
}

/// Mountings, and numbers of cameras, that are far from where the project has them: what is typed
/// wrong there is estimated all the same, but it may be the wrong tag, link or camera.
void RemarkOnMountings(ContactRun& run) {
  constexpr double kFarSds = 6.0;
  const std::vector<Source>& sources = run.model.setup.sources;
  const std::vector<QuantityValue>& values = run.calibrated.estimate.fit.values.quantities;
  std::vector<std::string> far;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const std::vector<int>& of = run.model.setup.quantities[k].sources;
    for (std::size_t first = 0, end = 0; first < of.size(); first = end) {
      while (end < of.size() && of[end] == of[first]) ++end;
      if (of[first] < kCommonSources) continue;  // of nobody's project
      const Source& source = sources[static_cast<std::size_t>(of[first])];
      const auto count = static_cast<Eigen::Index>(end - first);
      const auto at = static_cast<Eigen::Index>(first);
      const bool turn = source.unit == SourceUnit::kRadian && count == 3;
      const double off =
          turn ? RotationAngle(run.model.setup.quantities[k].origin.linear().transpose() *
                               values[k].Rotation(static_cast<int>(first)))
               : values[k].x.segment(at, count).norm();
      if (!(off > kFarSds * source.sd)) continue;
      const bool share = source.unit == SourceUnit::kNone;  // of the focal lengths
      const ShownUnit unit = ShownUnitOf(source.unit);
      far.push_back(fmt::format("{} by {:.3g} {} (within {:.3g} expected)", source.name,
                                share ? 1e2 * off : unit.factor * off, share ? "%" : unit.name,
                                share ? 1e2 * source.sd : unit.factor * source.sd));
    }
  }
  // No source says how far the normal of a plate may be off: its tilts are estimated whatever they
  // are.
  constexpr double kFarTilt = 20.0 / kDegreeHere;
  for (std::size_t p = 0; p < run.model.setup.plates.size(); ++p) {
    const int tilts = run.model.setup.instruments[p]->quantities.front();
    const double off = values[static_cast<std::size_t>(tilts)].x.norm();
    if (!(off > kFarTilt)) continue;
    far.push_back(fmt::format("the normal of plate '{}' by {:.3g} degrees",
                              run.model.setup.plates[p].name, kDegreeHere * off));
  }
  if (far.empty()) return;
  run.verdict.remarks.push_back(fmt::format(
      "far from where the project has it: {}. Is it the right one, and its axes, corners "
      "and centre as the project has them?",
      fmt::join(far, "; ")));
}

/// A covariance of poses in other units, or with rotations first, is not of what is left of them.
void RemarkOnCovariances(ContactRun& run) {
  constexpr double kOtherShape = 10.0;  // model errors change the shape by less
  const ObservationFigures good = FiguresOfGood(run);
  const bool any = std::any_of(good.rows.begin(), good.rows.end(),
                               [](const RowErrors& row) { return row.observations > 0; });
  const std::vector<RowErrors>& rows = any ? good.rows : run.calibrated.in_sample.rows;
  for (const RowErrors& place : rows) {
    const Eigen::MatrixXd& whitening = run.model.instrument(place.instrument).whitening;
    const auto turn = std::find_if(rows.begin(), rows.end(), [&](const RowErrors& row) {
      return row.instrument == place.instrument && row.unit == SourceUnit::kRadian;
    });
    if (whitening.size() == 0 || place.unit != SourceUnit::kMetre || turn == rows.end()) continue;
    const Eigen::MatrixXd stated = InverseOfInformation(whitening.transpose() * whitening);
    const double place_sd = std::sqrt(stated.topLeftCorner(3, 3).trace() / 3.0);
    const double turn_sd = std::sqrt(stated.bottomRightCorner(3, 3).trace() / 3.0);
    const double ratio = place.rms * turn_sd / (place_sd * turn->rms);
    if (ratio > 1.0 / kOtherShape && ratio < kOtherShape) continue;
    run.verdict.remarks.push_back(fmt::format(
        "the covariance of {}: positions and rotations are off by {:.2g} mm and {:.2g} degrees, "
        "where it says {:.2g} mm and {:.2g} degrees, up to a factor in common: m and rad, "
        "positions first, were expected",
        run.model.instrument(place.instrument).name, 1e3 * place.rms, kDegreeHere * turn->rms,
        1e3 * place_sd, kDegreeHere * turn_sd));
  }
}

/// How many times as large the tag seems as the project says, by its images that were left out; 1
/// for what is no tag.
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

/// Of instruments of which there are several, those most of whose observations were left out, if
/// they are left out more than all others: a sentence each. Such a thing is wrong as a whole.
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

/// Of what no robot explains, one sentence; nothing where all is plausible.
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

/// What seems to be wrong with the tables, before what follows from it.
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

std::vector<std::string> WorseRows(const ObservedRobot& model, const ObservationFigures& before,
                                   const ObservationFigures& after) {
  std::vector<std::string> worse;
  for (std::size_t i = 0; i < after.rows.size(); ++i) {
    const double matters = kMatters * LargestError(model, after.rows[i].unit);
    if (!(after.rows[i].rms > std::max(matters, kClearlyWorse * before.rows[i].rms))) continue;
    worse.push_back(fmt::format("{} from {} to {} {}", RowName(model, after.rows[i]),
                                FigureOf(before.rows[i]), FigureOf(after.rows[i]),
                                ShownUnitOf(after.rows[i].unit).name));
  }
  return worse;
}

std::vector<std::string> LargeErrors(const ObservedRobot& model,
                                     const ObservationFigures& figures) {
  std::vector<std::string> large;
  for (const RowErrors& row : figures.rows) {
    if (row.rms <= LargestError(model, row.unit)) continue;
    large.push_back(fmt::format("{} off by {} {}", RowName(model, row), FigureOf(row),
                                ShownUnitOf(row.unit).name));
  }
  return large;
}

void JudgeContacts(ContactRun& run) {
  Verdict& verdict = run.verdict;
  const bool held_out = run.calibrated.held_out.folds > 0;
  const bool touches = run.touches_only();
  const std::string what = touches ? "touches" : "observations";
  const std::string on =
      held_out ? "on " + what + " that were left out" : "on the " + what + " of the fit";
  if (run.calibrated.estimate.fit.termination != Termination::kConverged) {
    verdict.objections.emplace_back(
        "the estimate has not converged: variances did not come to rest");
  }
  if (!run.wrong_rows.empty()) verdict.objections.push_back(run.wrong_rows);
  const auto left_out = static_cast<double>(run.calibrated.estimate.outliers.size());
  if (left_out > kMostLeftOut * run.observations.count()) {
    verdict.objections.push_back(
        fmt::format("{:.0f} of {} {} are outliers", left_out, run.observations.count(), what));
  }
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
  ObjectToNonsense(run);
  const bool mistaken = run.mistakes && !run.mistakes->empty();
  if ((verdict.objections.empty() && !mistaken) || !NameMistakes(run)) {
    const std::string fault =
        FindObservedFault(run.model, run.observations, run.calibrated.estimate.fit);
    if (!fault.empty()) verdict.objections.insert(verdict.objections.begin(), fault);
  }
  const std::vector<std::string> wrong = WrongAsAWhole(run);
  std::vector<std::string>& said =
      verdict.objections.empty() ? verdict.remarks : verdict.objections;
  said.insert(said.begin(), wrong.begin(), wrong.end());
  if (verdict.objections.empty()) RemarkOnNoise(run);
  RemarkOnCovariances(run);
  if (verdict.objections.empty()) RemarkOnMountings(run);
  if (!held_out && !mistaken) {
    verdict.remarks.push_back("no " + std::string(touches ? "touch" : "posture") +
                              " was left out (--kfold 0): nothing was validated");
  }
  if (run.geometric) AddUrdfAlone(run, on);
  if (run.calibrated.held_out.unsettled > 0) {
    verdict.remarks.push_back(fmt::format("{} of {} folds have not converged",
                                          run.calibrated.held_out.unsettled,
                                          run.calibrated.held_out.folds));
  }
  if (run.model.setup.feet.size() > 1) verdict.remarks.push_back(DescribeClosure(run.closure));
}

}  // namespace elastocal
