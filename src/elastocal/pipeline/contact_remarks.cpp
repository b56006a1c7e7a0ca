// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/contact_remarks.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "elastocal/calibration/posterior.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/pipeline/contact_figures.hpp"
#include "elastocal/pipeline/contact_json.hpp"

namespace elastocal {
namespace {

constexpr double kMuchNoise = 4.0;  // times the noise in the project

/// Mountings and parameters of cameras that are far from the project's, relative to the accuracy
/// that it states.
std::vector<std::string> FarQuantities(const ContactRun& run) {
  constexpr double kFarSds = 6.0;
  const std::vector<Source>& sources = run.model.setup.sources;
  const std::vector<QuantityValue>& values = run.calibrated.estimate.fit.values.quantities;
  std::vector<std::string> far;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const std::vector<int>& of = run.model.setup.quantities[k].sources;
    for (std::size_t first = 0, end = 0; first < of.size(); first = end) {
      while (end < of.size() && of[end] == of[first]) ++end;
      if (of[first] < kCommonSources) continue;  // not from the project
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
  return far;
}

/// Names tilts of plates that are far from the project's. No source limits them, so that they are
/// estimated whatever they are.
std::vector<std::string> FarTilts(const ContactRun& run) {
  constexpr double kFarTilt = 20.0 * kRadiansPerDegree;
  const std::vector<QuantityValue>& values = run.calibrated.estimate.fit.values.quantities;
  std::vector<std::string> far;
  for (std::size_t p = 0; p < run.model.setup.plates.size(); ++p) {
    const int tilts = run.model.setup.instruments[p]->quantities.front();
    const double off = values[static_cast<std::size_t>(tilts)].x.norm();
    if (!(off > kFarTilt)) continue;
    far.push_back(fmt::format("the normal of plate '{}' by {:.3g} degrees",
                              run.model.setup.plates[p].name, off / kRadiansPerDegree));
  }
  return far;
}

}  // namespace

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

void RemarkOnMountings(ContactRun& run) {
  std::vector<std::string> far = FarQuantities(run);
  for (std::string& tilt : FarTilts(run)) far.push_back(std::move(tilt));
  if (far.empty()) return;
  run.verdict.remarks.push_back(fmt::format(
      "far from where the project has it: {}. Is it the right one, and its axes, corners "
      "and centre as the project has them?",
      fmt::join(far, "; ")));
}

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
        run.model.instrument(place.instrument).name, 1e3 * place.rms, turn->rms / kRadiansPerDegree,
        1e3 * place_sd, turn_sd / kRadiansPerDegree));
  }
}

}  // namespace elastocal
