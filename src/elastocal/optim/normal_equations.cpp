#include "elastocal/optim/normal_equations.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <Eigen/Cholesky>

namespace elastocal {
namespace {

constexpr double kEliminationRidge = 1e-12;  // as in Linearise
constexpr int kMostActiveSets = 20;

/// Of a residual block's sum of squares, half the loss and the weight.
struct Loss {
  double cost, weight;
};

Loss LossOf(const LeastSquaresProblem::ResidualBlock& block, double squares, double cauchy_scale) {
  if (!block.robust || cauchy_scale <= 0.0) return {0.5 * squares, 1.0};
  const double c2 = cauchy_scale * cauchy_scale;
  return {0.5 * c2 * std::log1p(squares / c2), 1.0 / (1.0 + squares / c2)};
}

}  // namespace

/// Adds up the residual blocks that share a nuisance block (or none) and reduces them.
class NormalEquations::Builder {
 public:
  Builder(const LeastSquaresProblem& problem, const std::vector<std::vector<int>>& components,
          double cauchy_scale, NormalEquations& equations)
      : problem_(problem),
        components_(components),
        cauchy_scale_(cauchy_scale),
        out_(equations),
        first_(1, 0) {
    for (int size : problem.parameter_blocks) first_.push_back(first_.back() + size);
  }

  int first(int parameter_block) const { return first_[parameter_block]; }

  /// `position`: of each entry of x among the unknowns.
  void Add(int nuisance, const std::vector<int>& blocks, const std::vector<int>& position) {
    const int size = nuisance < 0 ? 0 : problem_.parameter_blocks[nuisance];
    CollectColumns(nuisance, blocks, position);
    const auto width = static_cast<Eigen::Index>(columns_.size());
    A_.setZero(width, width);
    B_.setZero(size, width);
    g_.setZero(width);
    own_gradient_.setZero(size);
    own_.clear();
    int main = -1;
    for (int block : blocks) {
      if (problem_.residual_blocks[block].active) AddBlock(nuisance, block, main);
    }
    A_.triangularView<Eigen::StrictlyUpper>() = A_.transpose();
    if (size > 0) Eliminate(nuisance, main);
    const auto to = static_cast<std::size_t>(main + 1);
    Eigen::MatrixXd& total = out_.by_component_[to];
    for (Eigen::Index c = 0; c < width; ++c) {
      for (Eigen::Index r = 0; r < width; ++r) total(columns_[r], columns_[c]) += A_(r, c);
      out_.gradient_[columns_[c]] += g_[c];
    }
  }

 private:
  void CollectColumns(int nuisance, const std::vector<int>& blocks,
                      const std::vector<int>& position) {
    local_.assign(problem_.parameter_blocks.size(), -1);
    columns_.clear();
    for (int block : blocks) {
      for (int k : problem_.residual_blocks[block].parameter_blocks) {
        if (k == nuisance || local_[k] >= 0) continue;
        local_[k] = static_cast<int>(columns_.size());
        for (int i = first_[k]; i < first_[k + 1]; ++i) columns_.push_back(position[i]);
      }
    }
  }

  void AddBlock(int nuisance, int block, int& main) {
    const auto& shape = problem_.residual_blocks[block];
    Eigen::VectorXd r(shape.size);
    problem_.Residual(block, Eigen::Map<Eigen::VectorXd>(r.data(), r.size()));
    const Loss loss = LossOf(shape, r.squaredNorm(), cauchy_scale_);
    const double factor = std::sqrt(loss.weight);
    out_.cost_ += loss.cost;
    r *= factor;
    if (main < 0) main = components_[block][0];
    const std::size_t count = shape.parameter_blocks.size();
    parts_.resize(std::max(parts_.size(), count));
    for (std::size_t k = 0; k < count; ++k) {
      const int width = problem_.parameter_blocks[shape.parameter_blocks[k]];
      parts_[k].resize(shape.size, width);
      problem_.Jacobian(
          block, static_cast<int>(k),
          Eigen::Map<LeastSquaresProblem::RowMajorMatrix>(parts_[k].data(), shape.size, width));
      parts_[k] *= factor;
    }
    const LeastSquaresProblem::RowMajorMatrix* own = nullptr;
    for (std::size_t k = 0; k < count; ++k) {
      if (shape.parameter_blocks[k] == nuisance) own = &parts_[k];
    }
    if (own != nullptr) {
      own_.push_back({block, factor, *own});
      own_gradient_.noalias() += own->transpose() * r;
    }
    for (std::size_t a = 0; a < count; ++a) {
      const int at = local_[shape.parameter_blocks[a]];
      if (&parts_[a] == own) continue;
      const auto& Ja = parts_[a];
      g_.segment(at, Ja.cols()).noalias() += Ja.transpose() * r;
      if (own != nullptr) B_.middleCols(at, Ja.cols()) += own->transpose().lazyProduct(Ja);
      for (std::size_t b = 0; b < count; ++b) {
        const int under = local_[shape.parameter_blocks[b]];
        if (&parts_[b] == own || under < at) continue;
        A_.block(under, at, parts_[b].cols(), Ja.cols()) += parts_[b].transpose().lazyProduct(Ja);
      }
    }
  }

  void Eliminate(int nuisance, int main) {
    const Eigen::Index size = B_.rows();
    Eigen::MatrixXd D = kEliminationRidge * Eigen::MatrixXd::Identity(size, size);
    for (const OwnColumns& own : own_) D.noalias() += own.E.transpose() * own.E;
    const Eigen::LLT<Eigen::MatrixXd> cholesky(D);
    Eliminated eliminated;
    eliminated.first = first_[nuisance];
    eliminated.columns = columns_;
    eliminated.gain = cholesky.solve(B_);
    eliminated.own = cholesky.solve(own_gradient_);
    A_.noalias() -= B_.transpose() * eliminated.gain;
    g_.noalias() -= B_.transpose() * eliminated.own;
    for (const auto& [block, factor, E] : own_) {
      const Eigen::MatrixXd explained = cholesky.solve(E.transpose());
      AddRows(block, factor, E, explained, main, eliminated.gain);
    }
    out_.eliminated_.push_back(std::move(eliminated));
  }

  /// What the nuisance explains of a block's rows; keeps those that are not of the main component.
  void AddRows(int block, double factor, const Eigen::MatrixXd& E, const Eigen::MatrixXd& explained,
               int main, const Eigen::MatrixXd& gain) {
    const std::vector<int>& of_row = components_[block];
    for (Eigen::Index row = 0; row < E.rows();) {
      const int component = of_row[static_cast<std::size_t>(row)];
      Eigen::Index end = row;
      for (; end < E.rows() && of_row[static_cast<std::size_t>(end)] == component; ++end) {
        if (component >= 0) {
          out_.by_nuisance_[component] += E.row(end).dot(explained.col(end));
        }
      }
      if (component != main && component >= 0) {
        MinorRows minor{main, component, out_.eliminated_.size(), {}};
        minor.rows = -E.middleRows(row, end - row) * gain;
        AddJacobian(block, row, factor, minor.rows);
        out_.minor_.push_back(std::move(minor));
      }
      row = end;
    }
  }

  void AddJacobian(int block, Eigen::Index row, double factor, Eigen::MatrixXd& rows) const {
    const auto& shape = problem_.residual_blocks[block];
    for (std::size_t k = 0; k < shape.parameter_blocks.size(); ++k) {
      const int parameter = shape.parameter_blocks[k];
      if (local_[parameter] < 0) continue;
      LeastSquaresProblem::RowMajorMatrix J(shape.size, problem_.parameter_blocks[parameter]);
      problem_.Jacobian(
          block, static_cast<int>(k),
          Eigen::Map<LeastSquaresProblem::RowMajorMatrix>(J.data(), J.rows(), J.cols()));
      rows.middleCols(local_[parameter], J.cols()) += factor * J.middleRows(row, rows.rows());
    }
  }

  struct OwnColumns {
    int block;
    double factor;  // of the block's residuals and derivatives
    LeastSquaresProblem::RowMajorMatrix E;
  };

  const LeastSquaresProblem& problem_;
  const std::vector<std::vector<int>>& components_;
  double cauchy_scale_;
  NormalEquations& out_;
  std::vector<int> first_;    // entry of x, by parameter block
  std::vector<int> local_;    // column of the group in hand, by parameter block; -1
  std::vector<int> columns_;  // of the group in hand, among the unknowns
  Eigen::MatrixXd A_, B_;
  Eigen::VectorXd g_, own_gradient_;
  std::vector<LeastSquaresProblem::RowMajorMatrix> parts_;
  std::vector<OwnColumns> own_;
};

NormalEquations::NormalEquations(LeastSquaresProblem& problem, const Eigen::VectorXd& x,
                                 const std::vector<int>& nuisance_blocks,
                                 const std::vector<std::vector<int>>& components,
                                 double cauchy_scale)
    : size_(x.size()) {
  problem.Evaluate(x, true);
  std::vector<char> is_nuisance(problem.parameter_blocks.size(), 0);
  for (int k : nuisance_blocks) is_nuisance[k] = 1;
  int component_count = 0;
  for (const std::vector<int>& rows : components) {
    for (int component : rows) component_count = std::max(component_count, component + 1);
  }
  Builder builder(problem, components, cauchy_scale, *this);
  std::vector<int> position(static_cast<std::size_t>(size_), -1);
  for (std::size_t k = 0; k < problem.parameter_blocks.size(); ++k) {
    if (is_nuisance[k]) continue;
    const int first = builder.first(static_cast<int>(k));
    for (int i = 0; i < problem.parameter_blocks[k]; ++i) {
      position[first + i] = static_cast<int>(unknowns_.size());
      unknowns_.push_back(first + i);
    }
  }
  const auto size = static_cast<Eigen::Index>(unknowns_.size());
  gradient_.setZero(size);
  by_nuisance_.setZero(component_count);
  by_component_.assign(component_count + 1, Eigen::MatrixXd::Zero(size, size));

  // By nuisance block; those without one by themselves.
  std::map<int, std::vector<int>> groups;
  for (std::size_t i = 0; i < problem.residual_blocks.size(); ++i) {
    const auto& met = problem.residual_blocks[i].parameter_blocks;
    const auto own =
        std::find_if(met.begin(), met.end(), [&](int k) { return is_nuisance[k] != 0; });
    const int block = static_cast<int>(i);
    if (own == met.end()) {
      builder.Add(-1, {block}, position);
    } else {
      groups[*own].push_back(block);
    }
  }
  for (const auto& [nuisance, blocks] : groups) builder.Add(nuisance, blocks, position);
  information_.setZero(size, size);
  for (const Eigen::MatrixXd& part : by_component_) information_ += part;
}

Eigen::VectorXd NormalEquations::Explained(const Eigen::MatrixXd& covariance) const {
  Eigen::VectorXd explained = by_nuisance_;
  for (Eigen::Index k = 0; k < explained.size(); ++k) {
    explained[k] += by_component_[static_cast<std::size_t>(k) + 1].cwiseProduct(covariance).sum();
  }
  for (const MinorRows& minor : minor_) {
    const std::vector<int>& columns = eliminated_[minor.eliminated].columns;
    const Eigen::MatrixXd own = covariance(columns, columns);
    const double share = (minor.rows * own).cwiseProduct(minor.rows).sum();
    explained[minor.component] += share;
    explained[minor.main] -= share;
  }
  return explained;
}

Eigen::VectorXd NormalEquations::Expand(const Eigen::VectorXd& step) const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(size_);
  all(unknowns_) = step;
  for (const Eliminated& block : eliminated_) {
    all.segment(block.first, block.own.size()) = -block.own - block.gain * step(block.columns);
  }
  return all;
}

double CostOf(const LeastSquaresProblem& problem, double cauchy_scale) {
  double cost = 0.0;
  Eigen::VectorXd residual;
  for (std::size_t block = 0; block < problem.residual_blocks.size(); ++block) {
    const auto& shape = problem.residual_blocks[block];
    if (!shape.active) continue;
    residual.resize(shape.size);
    problem.Residual(static_cast<int>(block),
                     Eigen::Map<Eigen::VectorXd>(residual.data(), residual.size()));
    cost += LossOf(shape, residual.squaredNorm(), cauchy_scale).cost;
  }
  return cost;
}

Eigen::VectorXd BoundedStep(const Eigen::MatrixXd& information, const Eigen::VectorXd& gradient,
                            const Eigen::VectorXd& x, const std::vector<int>& nonnegative) {
  std::vector<char> held(static_cast<std::size_t>(x.size()), 0);
  for (int i : nonnegative) held[i] = x[i] <= 0.0 && gradient[i] >= 0.0;
  Eigen::VectorXd step = Eigen::VectorXd::Zero(x.size());
  for (int round = 0; round < kMostActiveSets; ++round) {
    std::vector<int> free;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      if (held[i]) {
        step[i] = -x[i];
      } else {
        step[i] = 0.0;
        free.push_back(static_cast<int>(i));
      }
    }
    const Eigen::VectorXd slope = gradient + information * step;
    const Eigen::MatrixXd own = information(free, free);
    step(free) = -own.llt().solve(slope(free));
    bool changed = false;
    for (int i : nonnegative) {
      if (held[i] || x[i] + step[i] >= 0.0) continue;
      held[i] = 1;
      changed = true;
    }
    if (changed) continue;
    const Eigen::VectorXd left = gradient + information * step;
    for (int i : nonnegative) {
      if (!held[i] || left[i] >= -1e-9) continue;
      held[i] = 0;
      changed = true;
    }
    if (!changed) break;
  }
  for (int i : nonnegative) step[i] = std::max(step[i], -x[i]);
  return step;
}

}  // namespace elastocal
