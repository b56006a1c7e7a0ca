// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/observed_mistakes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/observation/observation_figures.hpp"
#include "elastocal/observation/observation_fit.hpp"
#include "elastocal/observation/observed_posture.hpp"
#include "elastocal/pipeline/contact_verdict.hpp"
#include "elastocal/pipeline/observed_conventions.hpp"
#include "elastocal/pipeline/observed_corrections.hpp"

namespace elastocal {
namespace {

constexpr double kLeftWithout = 0.1;
constexpr double kNearTheBest = 2.0;     // times the squares that the best one leaves
constexpr int kMostRowsOff = 2;          // by which rows are shifted
constexpr int kMostFittedPostures = 24;  // that are fitted
constexpr int kFewestRowsTried = 8;      // of few, anything is explained

/// Squares over the largest errors that calibrated robots have, summed over the kinds of rows.
double SquaresOf(const ObservedRobot& model, const Observations& some,
                 const ObservedValues& values) {
  const ObservationFigures figures = MakeFigures(model, some, LeftOf(model, some, values));
  double squares = 0.0;
  for (const RowErrors& row : figures.rows) {
    squares += std::pow(row.rms / LargestError(model, row.unit), 2);
  }
  return std::isfinite(squares) ? squares : std::numeric_limits<double>::infinity();
}

/// Places the nominal robot among what it sees.
ObservedValues Placed(const ObservedRobot& model, const Observations& some) {
  InterruptionPoint();
  return FitObservations(model, some, StartFit(model, some),
                         {.freedom = {.robot = false}, .estimate_spread = false})
      .values;
}

/// What is left of some of the postures, evenly spread, once the nominal robot is placed; infinite
/// where it cannot be.
double PlacedSquares(const ObservedRobot& model, const Observations& all) {
  if (all.posture_count() < kFewestRowsTried) return std::numeric_limits<double>::infinity();
  const int stride = 1 + all.posture_count() / kMostFittedPostures;
  std::vector<int> rows;
  for (int i = 0; i < all.posture_count(); i += stride) rows.push_back(i);
  const Observations some = SelectPostures(all, rows);
  return SquaresOf(model, some, Placed(model, some));
}

std::vector<int> Rows(int first, int end) {
  std::vector<int> rows;
  for (int i = first; i < end; ++i) rows.push_back(i);
  return rows;
}

struct TriedMistake {
  std::string what;  ///< with the name that undoes it
  double squares = 0.0;
};

/// Among the rows of a part of the tables.
class MistakeSearch {
 public:
  /// `name`: what `--accept` calls the part, "@day2.csv:14"; `where`: the same in words.
  MistakeSearch(const ObservedRobot& model, const Observations& part, std::string name,
                std::string where)
      : model_(model),
        part_(part),
        name_(std::move(name)),
        where_(std::move(where)),
        all_(Size(part.posture_count()), 1),
        before_(PlacedSquares(model, part)) {}

  std::vector<std::string> Run() {
    const RobotTree& tree = model_.robot.tree;
    std::vector<int> moving;  // coordinates
    for (int c = 0; c < tree.coordinate_count(); ++c) {
      const auto values = part_.q.col(c);
      if (values.maxCoeff() > values.minCoeff()) moving.push_back(c);
    }
    for (const int c : moving) TrySign(c);
    for (int rows = -kMostRowsOff; rows <= kMostRowsOff; ++rows) {
      if (rows != 0) TryShift(rows);
    }
    for (const WrittenConvention& convention : WrittenConventions(model_, part_)) {
      tried_.push_back({convention.what + where_ + ": " + convention.right + " was expected",
                        PlacedSquares(model_, convention.undone)});
    }
    std::vector<std::string> found = Found();
    if (!found.empty()) return found;
    for (std::size_t a = 0; a < moving.size(); ++a) {  // hundreds of a humanoid
      for (std::size_t b = a + 1; b < moving.size(); ++b) {
        if (Slides(moving[a]) == Slides(moving[b])) TryExchange(moving[a], moving[b]);
      }
    }
    for (int a = 0; a < static_cast<int>(model_.setup.instruments.size()); ++a) {
      for (int b = 0; b < a; ++b) {
        if (MeasureAlike(model_, a, b)) TryLabels(b, a);
      }
    }
    return Found();
  }

 private:
  const Joint& JointOf(int coordinate) const {
    const RobotTree& tree = model_.robot.tree;
    return tree.joints[Size(tree.coordinate_joint[Size(coordinate)])];
  }
  std::string NameOfJoint(int coordinate) const { return JointOf(coordinate).name; }
  bool Slides(int coordinate) const { return JointOf(coordinate).type == JointType::kPrismatic; }

  void Try(const std::string& what, const std::string& name, const Observations& undone) {
    tried_.push_back({fmt::format("{}{} (--accept {}{} corrects it)", what, where_, name, name_),
                      PlacedSquares(model_, undone)});
  }

  Observations With(const Eigen::MatrixXd& q) const {
    Observations undone = part_;
    undone.q = q;
    return undone;
  }

  void TrySign(int c) {
    Eigen::MatrixXd q = part_.q;
    q.col(c) *= -1.0;
    const std::string joint = NameOfJoint(c);
    Try(joint + ": the sign of its positions is reversed", "sign:" + joint, With(q));
  }

  void TryExchange(int a, int b) {
    Eigen::MatrixXd q = part_.q;
    q.col(a).swap(q.col(b));
    Try(NameOfJoint(a) + " and " + NameOfJoint(b) + ": their positions are exchanged",
        "exchange:" + NameOfJoint(a) + "," + NameOfJoint(b), With(q));
  }

  void TryLabels(int a, int b) {
    const std::string &first = model_.instrument(a).name, &second = model_.instrument(b).name;
    Try(first + " and " + second + ": what they measured is exchanged",
        "labels:" + first + "," + second, WithLabelsExchanged(part_, a, b, all_));
  }

  void TryShift(int rows) {
    const std::string one = rows > 0 ? "the next row" : "the row before";
    const std::string several =
        std::to_string(std::abs(rows)) + (rows > 0 ? " rows further" : " rows before");
    Try("what was observed belongs to the joint positions of " +
            (std::abs(rows) == 1 ? one : several),
        fmt::format("rows:{:+}", rows), WithRowsOf(part_, rows, all_));
  }

  std::vector<std::string> Found() {
    std::stable_sort(tried_.begin(), tried_.end(),
                     [](const auto& a, const auto& b) { return a.squares < b.squares; });
    std::vector<std::string> found;
    for (const TriedMistake& one : tried_) {
      if (one.squares > kLeftWithout * before_) break;
      if (one.squares > kNearTheBest * tried_.front().squares) break;
      found.push_back(one.what);
    }
    return found;
  }

  const ObservedRobot& model_;
  const Observations& part_;
  std::string name_, where_;
  std::vector<char> all_;
  double before_;
  std::vector<TriedMistake> tried_;
};

/// The posture from which on the nominal robot, placed among the first ones, no longer explains
/// what it sees; nothing where the first ones are no better than all.
std::optional<int> FirstUnexplained(const ObservedRobot& model, const Observations& of_file) {
  const int count = of_file.posture_count();
  const double all = PlacedSquares(model, of_file);
  for (int share = 2; count / share >= kFewestRowsTried; ++share) {
    const Observations first = SelectPostures(of_file, Rows(0, count / share));
    const ObservedValues placed = Placed(model, first);
    if (SquaresOf(model, first, placed) > kLeftWithout * all) continue;
    std::vector<double> logs;  // of what is left of each posture
    for (int i = 0; i < count; ++i) {
      logs.push_back(
          std::log(std::max(1e-12, SquaresOf(model, SelectPostures(of_file, {i}), placed))));
    }
    std::vector<double> sum = {0.0};
    for (const double of : logs) sum.push_back(sum.back() + of);
    int best = 0;
    double most = 0.0;  // the largest step between two means, in units of its standard error
    for (int n = count / share; n <= count - kFewestRowsTried; ++n) {
      const double before = sum[Size(n)] / n, after = (sum.back() - sum[Size(n)]) / (count - n);
      const double step = (after - before) * std::sqrt(1.0 * n * (count - n));
      if (step <= most) continue;
      most = step;
      best = n;
    }
    if (best > 0) return best;
  }
  return std::nullopt;
}

/// In the rows of one file alone: all of them, or from one on.
std::vector<std::string> FindInFile(const ObservedRobot& model, const Observations& of_file,
                                    const std::string& file, bool others) {
  if (others) {
    std::vector<std::string> found = MistakeSearch(model, of_file, "@" + file, " in " + file).Run();
    if (!found.empty()) return found;
  }
  const auto first = FirstUnexplained(model, of_file);
  if (!first) return {};
  const Observations rest = SelectPostures(of_file, Rows(*first, of_file.posture_count()));
  return MistakeSearch(model, rest, fmt::format("@{}:{}", file, *first + 1),
                       fmt::format(" from posture {} of {} on", *first + 1, file))
      .Run();
}

}  // namespace

std::vector<std::string> FindObservedMistakes(const ObservedRobot& model,
                                              const Observations& observations) {
  std::vector<std::string> found = MistakeSearch(model, observations, "", "").Run();
  if (!found.empty()) return found;
  struct File {
    std::string name;
    Observations rows;
    double squares = 0.0;
  };
  std::vector<File> files;
  for (std::size_t f = 0; f < observations.files.size(); ++f) {
    std::vector<int> rows;
    for (int i = 0; i < observations.posture_count(); ++i) {
      if (observations.postures[Size(i)].file == static_cast<int>(f)) rows.push_back(i);
    }
    if (static_cast<int>(rows.size()) < kFewestRowsTried) continue;
    const Observations of_file = SelectPostures(observations, rows);
    files.push_back({NameInAccept(observations.files[f]), of_file, PlacedSquares(model, of_file)});
  }
  double least = std::numeric_limits<double>::infinity();
  for (const File& file : files) least = std::min(least, file.squares);
  for (const File& file : files) {
    const bool sound_beside = least <= kLeftWithout * file.squares;
    if (files.size() > 1 && !sound_beside) continue;
    found = FindInFile(model, file.rows, file.name, files.size() > 1);
    if (!found.empty()) return found;
  }
  return {};
}

}  // namespace elastocal
