// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/contact_figures.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/observation/observed_posture.hpp"
#include "elastocal/pipeline/contact_json.hpp"

namespace elastocal {
namespace {

constexpr double kClearlyWorse = 1.25;  // ratio to the error before
constexpr double kMoreThanNoise = 0.1;  // share of LargestError below which an error may be noise

/// "position of lt"
std::string RowName(const ObservedRobot& model, const RowErrors& row) {
  return row.row + " of " + model.instrument(row.instrument).name;
}

std::string FigureOf(const RowErrors& row) {
  return fmt::format("{:.3g}", ShownUnitOf(row.unit).factor * row.rms);
}

}  // namespace

ObservationFigures FiguresOfGood(const ContactRun& run) {
  const ContactOutcome& outcome = run.calibrated;
  std::set<int> bad;
  for (const ObservationOutlier& outlier : outcome.estimate.outliers) {
    bad.insert(outlier.observation);
  }
  const std::vector<Eigen::VectorXd>& left =
      outcome.held_out.folds > 0 ? outcome.held_out.left : outcome.left;
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

std::string FiguresInWords(const ContactRun& run, const ObservationFigures& figures) {
  if (run.touches_only()) {
    return fmt::format("{:.2f} mm and {:.2f} degrees", 1e3 * figures.all.height,
                       figures.all.tilt() / kRadiansPerDegree);
  }
  std::vector<std::string> texts;
  for (const RowErrors& row : figures.rows) {
    texts.push_back(fmt::format("{} {} in {}", FigureOf(row), ShownUnitOf(row.unit).name,
                                RowName(run.model, row)));
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::vector<std::string> WorseRows(const ObservedRobot& model, const ObservationFigures& before,
                                   const ObservationFigures& after) {
  std::vector<std::string> worse;
  for (std::size_t i = 0; i < after.rows.size(); ++i) {
    const double matters = kMoreThanNoise * LargestError(model, after.rows[i].unit);
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

}  // namespace elastocal
