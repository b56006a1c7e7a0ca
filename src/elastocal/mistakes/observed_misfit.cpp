// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/observed_misfit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/observation/observation_figures.hpp"
#include "elastocal/observation/observation_fit.hpp"

namespace elastocal {
namespace {

constexpr int kMostMisfitPostures = 24;
constexpr int kMostUpdates = 50;           // a placement that has not converged by then is none
constexpr double kLeastTurn = M_PI / 4.0;  // rad
constexpr double kManySds = 3.0;

/// Index of the first of the three rotation numbers of a quantity, where the project states its
/// orientation.
/// stands.
std::optional<int> TurnOf(const Quantity& quantity, const std::vector<Source>& sources) {
  for (int i = 0; i + 2 < quantity.size(); ++i) {
    const int source = quantity.sources[Size(i)];
    if (sources[Size(source)].unit != SourceUnit::kRadian) continue;
    const bool three =
        quantity.sources[Size(i + 1)] == source && quantity.sources[Size(i + 2)] == source;
    return three && source != kUnknownTurn ? std::optional(i) : std::nullopt;
  }
  return std::nullopt;
}

double TurnedMountings(const ObservedRobot& model, const ObservedValues& values) {
  double squares = 0.0;
  for (std::size_t k = 0; k < model.setup.quantities.size(); ++k) {
    const Quantity& quantity = model.setup.quantities[k];
    const auto first = TurnOf(quantity, model.setup.sources);
    if (!first) continue;
    const Eigen::Matrix3d turn =
        quantity.origin.linear().transpose() * values.quantities[k].Rotation(*first);
    const double sd = model.setup.sources[Size(quantity.sources[Size(*first)])].sd;
    squares += std::pow(RotationAngle(turn) / std::max(kLeastTurn, kManySds * sd), 2);
  }
  return squares;
}

}  // namespace

double SquaresOf(const ObservedRobot& model, const Observations& some,
                 const ObservedValues& values) {
  const ObservationFigures figures = MakeFigures(model, some, LeftOf(model, some, values));
  double squares = 0.0;
  for (const RowErrors& row : figures.rows) {
    squares += std::pow(row.rms / LargestError(model, row.unit), 2);
  }
  return std::isfinite(squares) ? squares : std::numeric_limits<double>::infinity();
}

ObservedValues PlacedAmong(const ObservedRobot& model, const Observations& some) {
  InterruptionPoint();
  return FitObservations(
             model, some, StartFit(model, some),
             {.freedom = {.robot = false}, .estimate_spread = false, .max_updates = kMostUpdates})
      .values;
}

ObservedMisfit MisfitOfNominal(const ObservedRobot& model, const Observations& all) {
  if (all.posture_count() < kFewestRowsTried) return {std::numeric_limits<double>::infinity(), 0.0};
  const int stride = 1 + all.posture_count() / kMostMisfitPostures;
  std::vector<int> rows;
  for (int i = 0; i < all.posture_count(); i += stride) rows.push_back(i);
  const Observations some = SelectPostures(all, rows);
  const ObservedValues placed = PlacedAmong(model, some);
  return {SquaresOf(model, some, placed), TurnedMountings(model, placed)};
}

}  // namespace elastocal
