#include "elastocal/contact/touch_figures.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/parallel.hpp"
#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

constexpr int kFewestTouches = 4;  // three place a table, and one is judged

TouchErrors ErrorsOf(const Eigen::MatrixX3d& left) {
  TouchErrors errors;
  errors.touches = static_cast<int>(left.rows());
  if (left.rows() == 0) return errors;
  errors.height = RootMeanSquare(left.col(0));
  errors.tilt_x = RootMeanSquare(left.col(1));
  errors.tilt_y = RootMeanSquare(left.col(2));
  errors.largest_height = left.col(0).cwiseAbs().maxCoeff();
  return errors;
}

std::vector<int> TouchesOfPlate(const Touches& touches, int plate) {
  std::vector<int> which;
  for (int i = 0; i < touches.count(); ++i) {
    if (touches.touches[i].plate == plate) which.push_back(i);
  }
  return which;
}

}  // namespace

double TouchErrors::tilt() const { return std::sqrt(0.5 * (tilt_x * tilt_x + tilt_y * tilt_y)); }

TouchFigures MakeFigures(const ContactModel& model, const Touches& touches,
                         const Eigen::MatrixX3d& left) {
  TouchFigures figures{ErrorsOf(left), {}};
  for (int p = 0; p < static_cast<int>(model.setup.plates.size()); ++p) {
    figures.by_plate.push_back(ErrorsOf(left(TouchesOfPlate(touches, p), Eigen::all)));
  }
  return figures;
}

TouchCrossValidation CrossValidateTouches(const ContactModel& model, const Touches& touches,
                                          const ContactFreedom& freedom, int folds, int threads,
                                          const Progress& progress) {
  if (folds < 2 || folds > touches.count()) {
    throw InputError(std::to_string(folds) + " folds asked for; from 2 to the number of touches, " +
                     std::to_string(touches.count()) + ", were expected");
  }
  TouchCrossValidation validation;
  validation.folds = folds;
  validation.left.resize(touches.count(), 3);
  std::vector<char> settled(static_cast<std::size_t>(folds), 0);
  const auto validate = [&](std::size_t fold) {
    std::vector<int> rest;
    std::vector<int> held_out;
    for (int i = 0; i < touches.count(); ++i) {
      (i % folds == static_cast<int>(fold) ? held_out : rest).push_back(i);
    }
    const ContactEstimate estimate = EstimateContacts(model, SelectTouches(touches, rest), freedom);
    validation.left(held_out, Eigen::all) =
        LeftOfTouches(model, SelectTouches(touches, held_out), estimate.fit.values);
    settled[fold] = estimate.fit.settled ? 1 : 0;
  };
  ForAll(static_cast<std::size_t>(folds), threads, validate, progress);
  validation.figures = MakeFigures(model, touches, validation.left);
  validation.unsettled = static_cast<int>(std::count(settled.begin(), settled.end(), 0));
  return validation;
}

Eigen::MatrixX3d LeftAfterRegistration(const ContactModel& model, const Touches& touches,
                                       const ContactValues& values, const ContactSpread& spread) {
  for (int p = 0; p < static_cast<int>(model.setup.plates.size()); ++p) {
    const int count = static_cast<int>(TouchesOfPlate(touches, p).size());
    if (count > 0 && count < kFewestTouches) {
      throw InputError(touches.files.front() + ": plate '" + model.setup.plates[p].name + "' has " +
                       std::to_string(count) + " touches; at least " +
                       std::to_string(kFewestTouches) +
                       " were expected to register its table anew");
    }
  }
  ContactFit start;
  start.values = values;
  start.values.sessions.assign(touches.sessions.size(), Eigen::Vector3d::Zero());
  start.spread = spread;
  start.loads = ContactLoads(model, touches, values.robot);
  const ContactFitOptions options{.freedom = {false, false, true, true}, .estimate_spread = false};
  Eigen::MatrixX3d left(touches.count(), 3);
  for (int i = 0; i < touches.count(); ++i) {
    start.weights.assign(touches.touches.size(), 1.0);
    start.weights[i] = 0.0;
    const ContactFit fit = FitContacts(model, touches, start, options);
    left.row(i) = LeftOfTouches(model, touches, fit.values).row(i);
  }
  return left;
}

double GainInSds(const Eigen::MatrixX3d& before, const Eigen::MatrixX3d& after,
                 const ContactSpread& spread) {
  const Eigen::RowVector3d sds(spread[ContactSource::kHeight], spread[ContactSource::kTilt],
                               spread[ContactSource::kTilt]);
  const auto squares = [&](const Eigen::MatrixX3d& left) {
    return Eigen::VectorXd((left.array().rowwise() / sds.array()).square().rowwise().sum());
  };
  const Eigen::VectorXd gain = squares(before) - squares(after);
  const double mean = gain.mean();
  const auto count = static_cast<double>(gain.size());
  const double sd =
      std::sqrt((gain.array() - mean).square().sum() / std::max(1.0, count - 1.0) / count);
  return mean / std::max(sd, 1e-300);
}

}  // namespace elastocal
