// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/observation_figures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "elastocal/math/dense.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/parallel.hpp"
#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

// Root mean square errors that calibrated robots do not exceed.
constexpr double kLargestPlace = 0.02;  // m
constexpr double kLargestShare = 0.01;  // share of the robot's size
constexpr double kLargestTurn = 5.0 * M_PI / 180.0;
constexpr double kLargestAcceleration = 0.5;  // m/s^2
constexpr double kLargestPixel = 20.0;
constexpr int kFewestTouches = 4;  // three place a table, and one is judged

TouchErrors ErrorsOfTouches(const std::vector<Eigen::Vector3d>& left) {
  TouchErrors errors;
  errors.touches = static_cast<int>(left.size());
  if (left.empty()) return errors;
  const Eigen::Map<const Eigen::Matrix3Xd> all(left.front().data(), 3,
                                               static_cast<Eigen::Index>(left.size()));
  errors.height = RootMeanSquare(all.row(0).transpose());
  errors.tilt_x = RootMeanSquare(all.row(1).transpose());
  errors.tilt_y = RootMeanSquare(all.row(2).transpose());
  errors.largest_height = all.row(0).cwiseAbs().maxCoeff();
  return errors;
}

void AddRows(const ObservedRobot& model, const Observations& observations,
             const std::vector<Eigen::VectorXd>& left, int instrument,
             std::vector<RowErrors>& rows) {
  const std::vector<RowMeaning> meanings = model.instrument(instrument).rows();
  for (std::size_t first = 0; first < meanings.size();) {
    const std::string name = meanings[first].name;
    std::size_t end = first;
    while (end < meanings.size() && meanings[end].name == name) ++end;
    RowErrors errors{instrument, name, meanings[first].unit};
    const auto size = static_cast<Eigen::Index>(end - first);
    double squares = 0.0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      if (observations.all[i].instrument != instrument) continue;
      const auto own = left[i].segment(static_cast<Eigen::Index>(first), size);
      ++errors.observations;
      squares += own.squaredNorm();
      errors.largest = std::max(errors.largest, own.cwiseAbs().maxCoeff());
    }
    if (errors.observations > 0) {
      errors.rms = std::sqrt(squares / (errors.observations * static_cast<double>(size)));
      rows.push_back(errors);
    }
    first = end;
  }
}

/// Root mean square of each posture's residuals in units of the noise.
Eigen::ArrayXd ErrorsByPosture(const ObservedRobot& model, const Observations& observations,
                               const std::vector<Eigen::VectorXd>& left, const Spread& spread) {
  Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(observations.posture_count());
  Eigen::ArrayXd rows = squares;
  for (std::size_t i = 0; i < left.size(); ++i) {
    const Observation& of = observations.all[i];
    squares[of.posture] +=
        (model.instrument(of.instrument).Weights(spread) * left[i]).squaredNorm();
    rows[of.posture] += static_cast<double>(left[i].size());
  }
  return (squares / rows.max(1.0)).sqrt();
}

int CountTouches(const Observations& observations, int plate) {
  return static_cast<int>(
      std::count_if(observations.all.begin(), observations.all.end(),
                    [&](const Observation& of) { return of.instrument == plate; }));
}

}  // namespace

double TouchErrors::tilt() const { return std::sqrt(0.5 * (tilt_x * tilt_x + tilt_y * tilt_y)); }

ObservationFigures MakeFigures(const ObservedRobot& model, const Observations& observations,
                               const std::vector<Eigen::VectorXd>& left) {
  ObservationFigures figures;
  const std::size_t plates = model.setup.plates.size();
  std::vector<Eigen::Vector3d> all;
  std::vector<std::vector<Eigen::Vector3d>> by_plate(plates);
  for (std::size_t i = 0; i < left.size(); ++i) {
    const auto plate = static_cast<std::size_t>(observations.all[i].instrument);
    if (plate >= plates) continue;
    all.emplace_back(left[i]);
    by_plate[plate].emplace_back(left[i]);
  }
  figures.all = ErrorsOfTouches(all);
  for (const auto& of : by_plate) figures.by_plate.push_back(ErrorsOfTouches(of));
  for (std::size_t n = 0; n < model.setup.instruments.size(); ++n) {
    AddRows(model, observations, left, static_cast<int>(n), figures.rows);
  }
  return figures;
}

double NoiseOf(const ObservedRobot& model, const RowErrors& row, const Spread& spread) {
  const Instrument& instrument = model.instrument(row.instrument);
  const std::vector<RowMeaning> rows = instrument.rows();
  const Eigen::MatrixXd weights = instrument.Weights(spread);
  const Eigen::VectorXd variances =
      InverseOfPositive(Eigen::MatrixXd(weights.transpose() * weights)).diagonal();
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (row.row != rows[i].name) continue;
    sum += variances[static_cast<Eigen::Index>(i)];
    ++count;
  }
  return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

ObservationCrossValidation CrossValidate(const ObservedRobot& model,
                                         const Observations& observations,
                                         const ObservationFreedom& freedom, int folds, int threads,
                                         const Progress& progress) {
  const int postures = observations.posture_count();
  if (folds < 2 || folds > postures) {
    throw InputError(std::to_string(folds) +
                     " folds asked for; from 2 to the number of postures, " +
                     std::to_string(postures) + ", were expected");
  }
  ObservationCrossValidation validation;
  validation.folds = folds;
  validation.left.resize(observations.all.size());
  std::vector<char> settled(static_cast<std::size_t>(folds), 0);
  const auto validate = [&](std::size_t fold) {
    std::vector<int> rest;
    std::vector<int> held_out;
    for (int i = 0; i < postures; ++i) {
      (i % folds == static_cast<int>(fold) ? held_out : rest).push_back(i);
    }
    const ObservedEstimate estimate =
        EstimateObserved(model, SelectPostures(observations, rest), freedom);
    const std::vector<Eigen::VectorXd> left =
        LeftOf(model, SelectPostures(observations, held_out), estimate.fit.values);
    std::size_t next = 0;
    for (std::size_t i = 0; i < observations.all.size(); ++i) {
      if (observations.all[i].posture % folds != static_cast<int>(fold)) continue;
      validation.left[i] = left[next++];
    }
    settled[fold] = estimate.fit.settled ? 1 : 0;
  };
  ForAll(static_cast<std::size_t>(folds), threads, validate, progress);
  validation.figures = MakeFigures(model, observations, validation.left);
  validation.unsettled = static_cast<int>(std::count(settled.begin(), settled.end(), 0));
  return validation;
}

std::vector<Eigen::VectorXd> LeftAfterRegistration(const ObservedRobot& model,
                                                   const Observations& observations,
                                                   const ObservedValues& values,
                                                   const Spread& spread) {
  for (int p = 0; p < static_cast<int>(model.setup.plates.size()); ++p) {
    const int count = CountTouches(observations, p);
    if (count > 0 && count < kFewestTouches) {
      throw InputError(observations.files.front() + ": plate '" + model.setup.plates[p].name +
                       "' has " + std::to_string(count) + " touches; at least " +
                       std::to_string(kFewestTouches) +
                       " were expected to register its table anew");
    }
  }
  ObservationFit start = StartFit(model, observations);
  start.values.robot = values.robot;
  for (std::size_t i = 0; i < values.quantities.size(); ++i) {
    start.values.quantities[i] = values.quantities[i];
  }
  start.spread = spread;
  start.loads = ObservedLoads(model, observations, values.robot);
  const ObservationFitOptions options{.freedom = {false, false, true, true},
                                      .estimate_spread = false};
  std::vector<Eigen::VectorXd> left(observations.all.size());
  for (int posture = 0; posture < observations.posture_count(); ++posture) {
    for (std::size_t i = 0; i < left.size(); ++i) {
      start.weights[i] = observations.all[i].posture == posture ? 0.0 : 1.0;
    }
    const ObservationFit fit = FitObservations(model, observations, start, options);
    const std::vector<Eigen::VectorXd> of_fit = LeftOf(model, observations, fit.values);
    for (std::size_t i = 0; i < left.size(); ++i) {
      if (observations.all[i].posture == posture) left[i] = of_fit[i];
    }
  }
  return left;
}

double LargestError(const ObservedRobot& model, SourceUnit unit) {
  switch (unit) {
    case SourceUnit::kMetre:
      return std::max(kLargestPlace, kLargestShare * RobotSize(model.robot.tree));
    case SourceUnit::kRadian:
      return kLargestTurn;
    case SourceUnit::kAcceleration:
      return kLargestAcceleration;
    case SourceUnit::kPixel:
      return kLargestPixel;
    default:
      return std::numeric_limits<double>::infinity();
  }
}

double GainInSds(const ObservedRobot& model, const Observations& observations,
                 const std::vector<Eigen::VectorXd>& before,
                 const std::vector<Eigen::VectorXd>& after, const Spread& spread) {
  const Eigen::VectorXd gain = ErrorsByPosture(model, observations, before, spread) -
                               ErrorsByPosture(model, observations, after, spread);
  return gain.mean() / std::max(StandardErrorOfMean(gain), 1e-300);
}

}  // namespace elastocal
