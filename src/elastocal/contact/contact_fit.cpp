#include "elastocal/contact/contact_fit.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/calibration/posterior.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/optim/normal_equations.hpp"

namespace elastocal {
namespace {

constexpr double kSettled = 1e-4;         // relative change of a standard deviation
constexpr double kRoughlySettled = 1e-2;  // of a fit that only looks for outliers
constexpr double kSlightStep = 1e-9;      // of the cost
constexpr double kLeastNoise = 1e-9;      // m and rad: roundings
constexpr double kHuberShare = 0.99;      // of touches that count whole
constexpr double kOwnWeight = 1.0;        // numbers that the first guess of a variance stands for
constexpr double kLeastRows = 0.01;    // share of rows that is left over where it is all but zero
constexpr double kGrossFreedom = 4.0;  // of the Student distribution of touches

bool IsNoise(int source) {
  return source == static_cast<int>(ContactSource::kHeight) ||
         source == static_cast<int>(ContactSource::kTilt);
}

/// Sum of squares over a source's rows, in units of its standard deviation, how many rows they
/// are, how much of them the fit explains, and the squares of each touch.
struct SourceSum {
  double squares = 0.0, rows = 0.0, explained = 0.0;
  std::vector<double> of_touches;
};

std::vector<SourceSum> SumBySource(const ContactResiduals& residuals, const Touches& touches,
                                   const std::vector<Eigen::VectorXd>& explained) {
  std::vector<SourceSum> sums(kContactSourceCount);
  for (std::size_t b = 0; b < residuals.residual_blocks.size(); ++b) {
    if (!residuals.residual_blocks[b].active) continue;
    const int block = static_cast<int>(b);
    const std::vector<int>& sources = residuals.Sources(block);
    for (std::size_t row = 0; row < sources.size(); ++row) {
      if (sources[row] < 0) continue;
      const auto r = static_cast<Eigen::Index>(row);
      SourceSum& sum = sums[sources[row]];
      const double square = residuals.Residual(block)[r] * residuals.Residual(block)[r];
      sum.squares += square;
      sum.rows += 1.0;
      sum.explained += explained[b][r];
      if (block < touches.count()) sum.of_touches.push_back(square);
    }
  }
  return sums;
}

/// The largest relative change.
double UpdateSpread(const std::vector<SourceSum>& sums, bool robust, ContactSpread& spread) {
  static const ContactSpread kFirst;
  double change = 0.0;
  for (int s = 0; s < kContactSourceCount; ++s) {
    const SourceSum& sum = sums[s];
    if (sum.rows <= 0.0) continue;
    const double own = IsNoise(s) ? 0.0 : kOwnWeight;
    double squares = sum.squares;
    if (robust && IsNoise(s)) {
      const Eigen::Map<const Eigen::VectorXd> all(sum.of_touches.data(),
                                                  static_cast<Eigen::Index>(sum.of_touches.size()));
      squares = sum.rows * Median(all) / ChiSquareQuantile(0.5, 1.0);
    }
    const double left = std::max(kLeastRows * sum.rows, sum.rows - sum.explained);
    const double before = spread.sd[s];
    const double variance =
        (before * before * squares + own * kFirst.sd[s] * kFirst.sd[s]) / (left + own);
    spread.sd[s] = std::max(kLeastNoise, std::sqrt(variance));
    change = std::max(change, std::abs(std::log(spread.sd[s] / before)));
  }
  return change;
}

/// Huber's weights by the distance of each touch; those of 0 stay.
double UpdateWeights(const ContactResiduals& residuals, const ContactSpread& spread,
                     std::vector<double>& weights) {
  const double limit = ChiSquareQuantile(kHuberShare, 3.0);
  double change = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] <= 0.0) continue;
    const Eigen::Vector3d& left = residuals.Left(static_cast<int>(i));
    const double height = left[0] / spread[ContactSource::kHeight];
    const double square =
        height * height + left.tail<2>().squaredNorm() / std::pow(spread[ContactSource::kTilt], 2);
    const double weight = square <= limit ? 1.0 : std::sqrt(limit / square);
    change = std::max(change, std::abs(weight - weights[i]));
    weights[i] = weight;
  }
  return change;
}

void TakeCovariance(const ContactModel& model, const ContactResiduals& residuals,
                    const Eigen::MatrixXd& covariance, ContactFit& fit) {
  fit.covariance = residuals.scale().asDiagonal() * covariance * residuals.scale().asDiagonal();
  fit.entry_of_unknown.clear();
  for (int u = 0; u < model.unknown_count; ++u) {
    fit.entry_of_unknown.push_back(residuals.RobotEntry(u));
  }
}

/// Numbers of the touches that the unknowns explain, and how many are left.
void TakeCounts(const Touches& touches, const std::vector<Eigen::VectorXd>& explained,
                ContactFit& fit) {
  fit.effective_parameters = 0.0;
  double rows = 0.0;
  for (int i = 0; i < touches.count(); ++i) {
    if (fit.weights[i] <= 0.0) continue;
    fit.effective_parameters += explained[i].sum();
    rows += 3.0;
  }
  fit.degrees_of_freedom = std::max(1.0, rows - fit.effective_parameters);
}

/// One step with all that follows from its linearisation; whether all came to rest.
bool UpdateContacts(const ContactModel& model, const Touches& touches,
                    const ContactFitOptions& options, ContactFit& fit) {
  if (options.freedom.robot) fit.loads = ContactLoads(model, touches, fit.values.robot);
  ContactResiduals residuals(model, touches, fit.loads, fit.spread, fit.weights, options.freedom,
                             fit.values);
  const Eigen::VectorXd x = residuals.Start();
  residuals.Evaluate(x, true);
  const double cost = CostOf(residuals);
  const NormalEquations equations(residuals);
  const Eigen::MatrixXd covariance = InverseOfInformation(equations.information());
  const std::vector<Eigen::VectorXd> explained = equations.ExplainedVariances(covariance);
  const Eigen::VectorXd step =
      BoundedStep(equations.information(), equations.gradient(), x, residuals.nonnegative);
  const bool small = -equations.gradient().dot(step) < kSlightStep * (1.0 + cost);
  Eigen::VectorXd next = x + step;
  residuals.Evaluate(next, false);
  ++fit.iterations;
  if (!small && !(CostOf(residuals) <= cost)) {  // far from the solution: damped steps
    next = Solve(residuals, x).x;
    residuals.Evaluate(next, false);
  }
  fit.values = residuals.ToValues(next);
  TakeCovariance(model, residuals, covariance, fit);
  TakeCounts(touches, explained, fit);
  double change = 0.0;
  if (options.estimate_spread) {
    change = UpdateSpread(SumBySource(residuals, touches, explained), options.robust, fit.spread);
  }
  change = std::max(change, UpdateWeights(residuals, fit.spread, fit.weights));
  return options.robust ? change < kRoughlySettled : change < kSettled && small;
}

}  // namespace

ContactFit StartContacts(const ContactModel& model, const Touches& touches) {
  ContactFit fit;
  fit.values = NominalContacts(model, touches);
  fit.weights.assign(touches.touches.size(), 1.0);
  fit.loads = ContactLoads(model, touches, fit.values.robot);
  return fit;
}

ContactFit FitContacts(const ContactModel& model, const Touches& touches, const ContactFit& start,
                       const ContactFitOptions& options) {
  ContactFit fit = start;
  fit.settled = false;
  for (int update = 0; update < options.max_updates && !fit.settled; ++update) {
    fit.settled = UpdateContacts(model, touches, options, fit);
  }
  fit.termination = fit.settled ? Termination::kConverged : Termination::kNoConvergence;
  return fit;
}

Eigen::MatrixX3d LeftOfTouches(const ContactModel& model, const Touches& touches,
                               const ContactValues& values) {
  ContactValues at = values;
  at.sessions.resize(touches.sessions.size(), Eigen::Vector3d::Zero());
  const std::vector<JointLoads> loads = ContactLoads(model, touches, values.robot);
  const ContactSpread spread;
  const std::vector<double> weights(touches.touches.size(), 1.0);
  ContactResiduals residuals(model, touches, loads, spread, weights, {false, false, false, false},
                             at);
  residuals.Evaluate(Eigen::VectorXd(), false);
  Eigen::MatrixX3d left(touches.count(), 3);
  for (int i = 0; i < touches.count(); ++i) left.row(i) = residuals.Left(i);
  return left;
}

ContactEstimate EstimateContacts(const ContactModel& model, const Touches& touches,
                                 const ContactFreedom& freedom) {
  ContactEstimate estimate;
  ContactFit start = StartContacts(model, touches);
  const ContactFit robust =
      FitContacts(model, touches, start, {.freedom = freedom, .robust = true, .max_updates = 60});
  const double probability = model.setup.outlier_probability / std::max(1, touches.count());
  const double limit = 3.0 * FisherQuantile(1.0 - probability, 3.0, kGrossFreedom);
  Eigen::Array3d sds(robust.spread[ContactSource::kHeight], robust.spread[ContactSource::kTilt],
                     robust.spread[ContactSource::kTilt]);
  const Eigen::MatrixX3d left = LeftOfTouches(model, touches, robust.values);
  for (int i = 0; i < touches.count(); ++i) {
    const Eigen::Vector3d of = left.row(i);
    if ((of.array() / sds).square().sum() <= limit) continue;
    estimate.outliers.push_back({i, of});
    start.weights[i] = 0.0;
  }
  start.values = robust.values;
  start.spread = robust.spread;
  estimate.fit = FitContacts(model, touches, start, {.freedom = freedom});
  return estimate;
}

}  // namespace elastocal
