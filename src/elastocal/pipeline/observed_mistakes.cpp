// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/observed_mistakes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/observation/observation_figures.hpp"
#include "elastocal/observation/observation_fit.hpp"
#include "elastocal/observation/observed_posture.hpp"
#include "elastocal/pipeline/contact_verdict.hpp"
#include "elastocal/pipeline/observed_corrections.hpp"

namespace elastocal {
namespace {

constexpr double kLeftWithout = 0.1;
constexpr double kNearTheBest = 2.0;     // times the squares that the best one leaves
constexpr int kMostRowsOff = 2;          // by which rows are shifted
constexpr int kMostFittedPostures = 24;  // that are fitted
constexpr int kFewestRowsTried = 8;      // of few, anything is explained

struct TriedMistake {
  std::string what;  ///< with the name that undoes it
  double squares = 0.0;
};

class ObservedMistakeSearch {
 public:
  ObservedMistakeSearch(const ObservedRobot& model, const Observations& observations)
      : model_(model), observations_(observations), before_(Squares(observations)) {}

  std::vector<std::string> Run() {
    const RobotTree& tree = model_.robot.tree;
    std::vector<int> moving;  // coordinates
    for (int c = 0; c < tree.coordinate_count(); ++c) {
      const auto values = observations_.q.col(c);
      if (values.maxCoeff() > values.minCoeff()) moving.push_back(c);
    }
    for (const int c : moving) TrySign(c);
    for (int rows = -kMostRowsOff; rows <= kMostRowsOff; ++rows) {
      if (rows != 0) TryShift(rows);
    }
    std::vector<std::string> found = Found();
    if (!found.empty()) return found;
    for (std::size_t a = 0; a < moving.size(); ++a) {  // hundreds of a humanoid
      for (std::size_t b = a + 1; b < moving.size(); ++b) {
        if (Slides(moving[a]) == Slides(moving[b])) TryExchange(moving[a], moving[b]);
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

  /// Some postures, evenly spread.
  static Observations SomeOf(const Observations& all) {
    const int stride = 1 + all.posture_count() / kMostFittedPostures;
    std::vector<int> rows;
    for (int i = 0; i < all.posture_count(); i += stride) rows.push_back(i);
    return SelectPostures(all, rows);
  }

  /// Squares over the largest errors that calibrated robots have, summed over the kinds of rows,
  /// once the nominal robot is placed; infinite where it cannot be.
  double Squares(const Observations& all) const {
    InterruptionPoint();
    if (all.posture_count() < kFewestRowsTried) return std::numeric_limits<double>::infinity();
    const Observations some = SomeOf(all);
    const ObservationFit fit =
        FitObservations(model_, some, StartFit(model_, some),
                        {.freedom = {.robot = false}, .estimate_spread = false});
    const ObservationFigures figures = MakeFigures(model_, some, LeftOf(model_, some, fit.values));
    double squares = 0.0;
    for (const RowErrors& row : figures.rows) {
      squares += std::pow(row.rms / LargestError(model_, row.unit), 2);
    }
    return std::isfinite(squares) ? squares : std::numeric_limits<double>::infinity();
  }

  void Try(const std::string& what, const std::string& name, const Observations& undone) {
    tried_.push_back({what + " (--accept " + name + " corrects it)", Squares(undone)});
  }

  Observations With(const Eigen::MatrixXd& q) const {
    Observations undone = observations_;
    undone.q = q;
    return undone;
  }

  void TrySign(int c) {
    Eigen::MatrixXd q = observations_.q;
    q.col(c) *= -1.0;
    const std::string joint = NameOfJoint(c);
    Try(joint + ": the sign of its positions is reversed", "sign:" + joint, With(q));
  }

  void TryExchange(int a, int b) {
    Eigen::MatrixXd q = observations_.q;
    q.col(a).swap(q.col(b));
    Try(NameOfJoint(a) + " and " + NameOfJoint(b) + ": their positions are exchanged",
        "exchange:" + NameOfJoint(a) + "," + NameOfJoint(b), With(q));
  }

  void TryShift(int rows) {
    const std::string one = rows > 0 ? "the next row" : "the row before";
    const std::string several =
        std::to_string(std::abs(rows)) + (rows > 0 ? " rows further" : " rows before");
    Try("what was observed belongs to the joint positions of " +
            (std::abs(rows) == 1 ? one : several),
        "rows:" + std::string(rows > 0 ? "+" : "") + std::to_string(rows),
        WithRowsOf(observations_, rows));
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
  const Observations& observations_;
  double before_;
  std::vector<TriedMistake> tried_;
};

}  // namespace

std::vector<std::string> FindObservedMistakes(const ObservedRobot& model,
                                              const Observations& observations) {
  return ObservedMistakeSearch(model, observations).Run();
}

}  // namespace elastocal
