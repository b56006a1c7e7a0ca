// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/cause_search.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Cholesky>

#include "elastocal/calibration/cause_fit.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

constexpr double kNineInTen = 1.2816;  // quantile of the normal distribution
// Divisions into folds by which a search is judged as a whole, and postures of all divisions: the
// chance of a division matters in small tables.
constexpr int kMostDeals = 10, kMostJudged = 600;

double ErrorOf(const LinearStudy::Posture& posture, const Eigen::VectorXd& residual) {
  return std::sqrt(residual.cwiseProduct(posture.to_metres).squaredNorm() /
                   std::max(1, posture.markers));
}

/// Whether the 95 % interval of a mean gain over `postures` postures is above zero.
bool IsCertain(double gain, double sd, std::size_t postures) {
  return gain > StudentQuantile(0.975, std::max(1.0, static_cast<double>(postures) - 1.0)) * sd;
}

/// Whether a mean gain exceeds both its standard error and 5 % of `error`.
bool Matters(double gain, double sd, double error) { return gain > sd && gain > 0.05 * error; }

/// Divides the postures into folds at random.
std::vector<std::vector<int>> Deal(std::vector<int> postures, int folds, Random& random) {
  for (std::size_t i = postures.size() - 1; i > 0; --i) {
    std::swap(postures[i],
              postures[static_cast<std::size_t>(random.Index(static_cast<int>(i) + 1))]);
  }
  std::vector<std::vector<int>> dealt(static_cast<std::size_t>(folds));
  for (std::size_t i = 0; i < postures.size(); ++i) {
    dealt[i % dealt.size()].push_back(postures[i]);
  }
  return dealt;
}

/// Forward search for causes over some of the postures.
class Search {
 public:
  Search(const LinearStudy& study, const CauseSearchOptions& options, std::vector<int> postures,
         const StudySums& sums, std::uint64_t seed)
      : study_(study),
        options_(options),
        postures_(std::move(postures)),
        sums_(sums),
        seed_(seed) {}

  /// Tests every cause that is not taken, beside those that are. `significant`: only those that are
  /// significant are judged by held-out postures and returned.
  std::vector<CauseFinding> Findings(const std::vector<int>& taken, bool significant = false) {
    const BaseFit fit(study_, sums_, taken);
    PlaceBeside(fit);
    std::vector<CauseFinding> findings;
    causes_.clear();
    for (int cause = 0; cause < static_cast<int>(study_.causes.size()); ++cause) {
      if (std::find(taken.begin(), taken.end(), cause) != taken.end()) continue;
      findings.push_back(Test(fit, cause));
      causes_.push_back(cause);
    }
    Holm(findings);
    if (significant) KeepSignificant(findings);
    HeldOut(taken, findings);
    return findings;
  }

  std::vector<int> Forward(std::vector<CauseFinding>* chosen, std::vector<CauseFinding>* all) {
    std::vector<int> taken;
    while (static_cast<int>(taken.size()) < options_.most) {
      const std::vector<CauseFinding> findings = Findings(taken, chosen == nullptr);
      if (taken.empty() && all != nullptr) *all = findings;
      int best = -1;
      for (std::size_t i = 0; i < findings.size(); ++i) {
        if (!Helps(findings[i])) continue;
        if (best < 0 || findings[i].p < findings[static_cast<std::size_t>(best)].p) {
          best = static_cast<int>(i);
        }
      }
      if (best < 0) break;
      taken.push_back(causes_[static_cast<std::size_t>(best)]);
      if (chosen != nullptr) {
        chosen->push_back(findings[static_cast<std::size_t>(best)]);
        chosen->back().rivals = RivalsOf(chosen->back(), findings);
      }
    }
    return taken;
  }

  /// Root mean square held-out error of the base in the last call of Findings.
  double error() const { return error_; }

 private:
  bool Helps(const CauseFinding& finding) const {
    return finding.p_adjusted < options_.level &&
           (IsCertain(finding.mean_gain, finding.gain_sd, postures_.size()) ||
            Matters(finding.mean_gain, finding.gain_sd, error_));
  }

  /// Causes that explain what is left almost as well: the likelihoods differ by less than a factor
  /// of 20.
  std::vector<std::string> RivalsOf(const CauseFinding& best,
                                    const std::vector<CauseFinding>& findings) const {
    constexpr double kAlike = 6.0;  // limit of the difference of twice the log likelihood
    const auto explained = [](const CauseFinding& finding) {
      return finding.score * static_cast<double>(finding.parameters.size());
    };
    std::vector<std::string> rivals;
    for (const CauseFinding& finding : findings) {
      if (finding.cause == best.cause || finding.p_adjusted >= options_.level) continue;
      if (explained(finding) > explained(best) - kAlike) rivals.push_back(finding.cause);
    }
    return rivals;
  }

  CauseFinding Test(const BaseFit& fit, int cause) const {
    CauseFinding finding;
    finding.cause = study_.causes[static_cast<std::size_t>(cause)];
    const std::vector<int> at = fit.Positions(study_, cause);
    const auto count = static_cast<Eigen::Index>(at.size());
    const std::vector<int> columns = CauseColumns(study_, {cause});
    const CauseFit fitted = FitCause(study_, fit, cause);
    const Eigen::MatrixXd& information = fitted.information;
    const Eigen::LLT<Eigen::MatrixXd> factor(information);
    const Eigen::VectorXd gradient = fit.gradient(at);
    const double inflation = Inflation(at, fitted.step, factor);
    finding.score = gradient.dot(factor.solve(gradient)) / static_cast<double>(count) / inflation;
    finding.p = FisherUpperTail(std::max(0.0, finding.score), static_cast<double>(count),
                                study_.degrees_of_freedom);
    const Eigen::VectorXd& step = fitted.step;
    const Eigen::MatrixXd covariance = inflation * fitted.covariance;
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto correction =
          static_cast<std::size_t>(columns[static_cast<std::size_t>(i)] - study_.base);
      finding.parameters.push_back(study_.corrections[correction]);
      finding.estimate.push_back(study_.scale[correction] * step[i]);
      finding.sd.push_back(study_.scale[correction] * std::sqrt(covariance(i, i)));
    }
    SetVisible(fit, at, std::sqrt(inflation / information(0, 0)), finding);
    return finding;
  }

  /// Computes for each posture the columns of the causes beside the base, and the residual that the
  /// base leaves.
  void PlaceBeside(const BaseFit& fit) {
    beside_.resize(study_.postures.size());
    left_.resize(study_.postures.size());
    for (int i : postures_) {
      const auto posture = static_cast<std::size_t>(i);
      beside_[posture] = fit.Beside(study_.postures[posture]);
      left_[posture] = fit.Residual(study_.postures[posture]);
    }
  }

  /// Ratio of the scatter of the postures' scores, after the cause is fitted, to what the noise
  /// model expects; at least 1.
  double Inflation(const std::vector<int>& at, const Eigen::VectorXd& step,
                   const Eigen::LLT<Eigen::MatrixXd>& factor) const {
    double found = 0.0;
    double count = 0.0;
    for (int i : postures_) {
      const auto posture = static_cast<std::size_t>(i);
      if (left_[posture].size() == 0) continue;
      const Eigen::MatrixXd columns = beside_[posture](Eigen::all, at);
      const Eigen::VectorXd score = columns.transpose() * (left_[posture] + columns * step);
      found += score.dot(factor.solve(score));
      count += 1.0;
    }
    const auto size = static_cast<double>(at.size());
    return std::max(1.0, found / size * count / std::max(1.0, count - size));
  }

  void SetVisible(const BaseFit& fit, const std::vector<int>& at, double sd,
                  CauseFinding& finding) const {
    const auto causes = static_cast<double>(std::max<std::size_t>(1, study_.causes.size()));
    const double t = StudentQuantile(1.0 - 0.5 * options_.level / causes,
                                     std::max(1.0, study_.degrees_of_freedom));
    const double effect = (t + kNineInTen) * sd;
    double squares = 0.0;
    double markers = 0.0;
    for (int i : postures_) {
      const LinearStudy::Posture& posture = study_.postures[static_cast<std::size_t>(i)];
      if (posture.residual.size() == 0) continue;
      const Eigen::VectorXd moved = beside_[static_cast<std::size_t>(i)].col(at.front());
      squares += moved.cwiseProduct(posture.to_metres).squaredNorm();
      markers += posture.markers;
    }
    finding.visible = effect * std::sqrt(squares / std::max(1.0, markers));
    const auto first =
        static_cast<std::size_t>(fit.others[static_cast<std::size_t>(at.front())] - study_.base);
    finding.visible_effect = effect * study_.scale[first];
  }

  static void Holm(std::vector<CauseFinding>& findings) {
    std::vector<std::size_t> order(findings.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return std::pair(findings[a].p, a) < std::pair(findings[b].p, b);
    });
    double largest = 0.0;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const auto left = static_cast<double>(order.size() - i);
      largest = std::max(largest, std::min(1.0, left * findings[order[i]].p));
      findings[order[i]].p_adjusted = largest;
    }
  }

  void KeepSignificant(std::vector<CauseFinding>& findings) {
    std::vector<CauseFinding> kept;
    std::vector<int> causes;
    for (std::size_t i = 0; i < findings.size(); ++i) {
      if (!(findings[i].p_adjusted < options_.level)) continue;
      kept.push_back(std::move(findings[i]));
      causes.push_back(causes_[i]);
    }
    findings = std::move(kept);
    causes_ = std::move(causes);
  }

  /// Computes the held-out errors without any further cause and with each.
  void HeldOut(const std::vector<int>& taken, std::vector<CauseFinding>& findings) {
    const auto rows = static_cast<Eigen::Index>(study_.postures.size());
    const auto count = static_cast<Eigen::Index>(findings.size());
    Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(rows, count + 1);
    Random random(seed_);
    for (int deal = 0; deal < options_.deals; ++deal) {
      const int folds = std::min(options_.folds, static_cast<int>(postures_.size()));
      for (const std::vector<int>& fold : Deal(postures_, folds, random)) {
        AddFold(taken, fold, squares);
      }
    }
    squares /= options_.deals;
    Summarise(squares, findings);
  }

  void AddFold(const std::vector<int>& taken, const std::vector<int>& fold,
               Eigen::MatrixXd& squares) const {
    StudySums training = sums_;
    for (int i : fold) training.Add(study_.postures[static_cast<std::size_t>(i)], -1.0);
    const BaseFit fit(study_, training, taken);
    std::vector<Eigen::VectorXd> steps;
    std::vector<std::vector<int>> at;
    for (int cause : causes_) {
      steps.push_back(FitCause(study_, fit, cause).step);
      at.push_back(fit.Positions(study_, cause));
    }
    for (int i : fold) {
      const LinearStudy::Posture& posture = study_.postures[static_cast<std::size_t>(i)];
      if (posture.residual.size() == 0) continue;
      const Eigen::VectorXd residual = fit.Residual(posture);
      const Eigen::MatrixXd beside = fit.Beside(posture);
      squares(i, 0) += std::pow(ErrorOf(posture, residual), 2);
      for (std::size_t k = 0; k < causes_.size(); ++k) {
        squares(i, static_cast<Eigen::Index>(k) + 1) +=
            std::pow(ErrorOf(posture, residual + beside(Eigen::all, at[k]) * steps[k]), 2);
      }
    }
  }

  void Summarise(const Eigen::MatrixXd& squares, std::vector<CauseFinding>& findings) {
    const auto rms = [&](Eigen::Index column) {
      double sum = 0.0, markers = 0.0;
      for (int i : postures_) {
        const double weight = study_.postures[static_cast<std::size_t>(i)].markers;
        sum += weight * squares(i, column);
        markers += weight;
      }
      return std::sqrt(sum / std::max(1.0, markers));
    };
    error_ = rms(0);
    const Eigen::MatrixXd errors = squares(postures_, Eigen::all).cwiseSqrt();
    for (std::size_t k = 0; k < findings.size(); ++k) {
      const Eigen::VectorXd gains = errors.col(0) - errors.col(static_cast<Eigen::Index>(k) + 1);
      findings[k].gain = error_ - rms(static_cast<Eigen::Index>(k) + 1);
      findings[k].mean_gain = gains.mean();
      findings[k].gain_sd = StandardErrorOfMean(gains);
    }
  }

  const LinearStudy& study_;
  const CauseSearchOptions& options_;
  std::vector<int> postures_;
  const StudySums& sums_;
  std::uint64_t seed_;
  std::vector<int> causes_;              // cause of each finding, by index in the study
  std::vector<Eigen::MatrixXd> beside_;  // by posture
  std::vector<Eigen::VectorXd> left_;    // by posture
  double error_ = 0.0;
};

/// By how much the errors of postures fall, from the squares of errors without causes and with
/// them.
Eigen::VectorXd GainsOf(const Eigen::MatrixX2d& squares, const std::vector<int>& postures) {
  const Eigen::MatrixX2d errors = squares(postures, Eigen::all).cwiseSqrt();
  return errors.col(0) - errors.col(1);
}

/// Repeats the search without a fold and judges its choice on that fold: adds the squared errors of
/// its postures without causes and with those that were chosen.
void JudgeFold(const LinearStudy& study, const CauseSearchOptions& options,
               const std::vector<int>& postures, const StudySums& all, std::vector<int> fold,
               Eigen::MatrixX2d& squares) {
  StudySums training = all;
  for (int i : fold) training.Add(study.postures[static_cast<std::size_t>(i)], -1.0);
  std::sort(fold.begin(), fold.end());
  std::vector<int> rest;
  std::set_difference(postures.begin(), postures.end(), fold.begin(), fold.end(),
                      std::back_inserter(rest));
  Search search(study, options, rest, training, options.seed);
  const std::vector<int> taken = search.Forward(nullptr, nullptr);
  const BaseFit without(study, training, {});
  const BaseFit with(study, training, taken);
  for (int i : fold) {
    const LinearStudy::Posture& posture = study.postures[static_cast<std::size_t>(i)];
    squares(i, 0) += std::pow(ErrorOf(posture, without.Residual(posture)), 2);
    squares(i, 1) += std::pow(ErrorOf(posture, with.Residual(posture)), 2);
  }
}

/// Judges the search as a whole by nested folds. One division into folds may happen to favour or to
/// hide a cause: the errors of a posture are means over several. The standard error of the gain
/// follows from the scatter within a division; neither divisions nor folds are independent, because
/// they train on common postures (Nadeau and Bengio, 2003).
void JudgeNested(const LinearStudy& study, const CauseSearchOptions& options,
                 const std::vector<int>& postures, const StudySums& all, CauseSearch& result) {
  Random random(options.seed);
  const int folds = std::min(options.folds, static_cast<int>(postures.size()));
  CauseSearchOptions inner = options;
  inner.deals = 1;
  const int deals = std::clamp(kMostJudged / static_cast<int>(postures.size()), 1, kMostDeals);
  const auto rows = static_cast<Eigen::Index>(study.postures.size());
  Eigen::MatrixX2d squares = Eigen::MatrixX2d::Zero(rows, 2);
  double variance = 0.0;
  for (int deal = 0; deal < deals; ++deal) {
    inner.seed = options.seed + 1 + static_cast<std::uint64_t>(deal);
    Eigen::MatrixX2d of_deal = Eigen::MatrixX2d::Zero(rows, 2);
    for (const std::vector<int>& fold : Deal(postures, folds, random)) {
      JudgeFold(study, inner, postures, all, fold, of_deal);
    }
    squares += of_deal / deals;
    variance += std::pow(StandardErrorOfMean(GainsOf(of_deal, postures)), 2) / deals;
  }
  Eigen::RowVector2d sums = Eigen::RowVector2d::Zero();
  double markers = 0.0;
  for (int i : postures) {
    const double weight = study.postures[static_cast<std::size_t>(i)].markers;
    sums += weight * squares.row(i);
    markers += weight;
  }
  result.error = std::sqrt(sums[0] / std::max(1.0, markers));
  result.nested_error = std::sqrt(sums[1] / std::max(1.0, markers));
  const Eigen::VectorXd gains = GainsOf(squares, postures);
  result.nested_gain = gains.mean();
  result.nested_gain_sd = std::sqrt(variance * (1.0 / deals + folds / (folds - 1.0)));
  result.accepted = IsCertain(result.nested_gain, result.nested_gain_sd, postures.size()) ||
                    Matters(result.nested_gain, StandardErrorOfMean(gains), result.error);
}

}  // namespace

CauseSearch SearchCauses(const LinearStudy& study, const CauseSearchOptions& options) {
  CauseSearch result;
  std::vector<int> postures;
  StudySums sums(study);
  for (std::size_t i = 0; i < study.postures.size(); ++i) {
    if (study.postures[i].residual.size() == 0) continue;
    postures.push_back(static_cast<int>(i));
    sums.Add(study.postures[i], 1.0);
  }
  if (postures.size() < 3 || study.causes.empty()) return result;
  Search search(study, options, postures, sums, options.seed);
  search.Forward(&result.chosen, &result.findings);
  search.Findings({});
  result.error = search.error();
  if (!result.chosen.empty()) JudgeNested(study, options, postures, sums, result);
  std::stable_sort(result.findings.begin(), result.findings.end(),
                   [](const CauseFinding& a, const CauseFinding& b) { return a.p < b.p; });
  return result;
}

}  // namespace elastocal
