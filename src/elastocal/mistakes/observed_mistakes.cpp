// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/observed_mistakes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/mistakes/observed_conventions.hpp"
#include "elastocal/mistakes/observed_corrections.hpp"
#include "elastocal/mistakes/observed_misfit.hpp"
#include "elastocal/mistakes/two_tables.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr double kLeftWithout = 0.1;
constexpr double kNearTheBest = 2.0;  // ratio to the squares that the best one leaves
constexpr int kMostRowsOff = 2;       // largest shift of rows

std::vector<int> Rows(int first, int end) {
  std::vector<int> rows;
  for (int i = first; i < end; ++i) rows.push_back(i);
  return rows;
}

struct TriedMistake {
  std::string what;         ///< with the name that corrects it
  double left = 0.0;        ///< share of the squares before
  std::string family = {};  ///< common name, used if others of its family are as good
};

/// Ratio to the squares before.
double ShareOf(double squares, double before) {
  return std::isfinite(squares) ? squares / before : std::numeric_limits<double>::infinity();
}

/// Search in the rows of a part of the tables.
class MistakeSearch {
 public:
  /// `name` is that of the part in `--accept`, "@day2.csv:14"; `where` is the same as text.
  MistakeSearch(const ObservedRobot& model, const Observations& part, std::string name,
                std::string where)
      : model_(model),
        part_(part),
        name_(std::move(name)),
        where_(std::move(where)),
        all_(Size(part.posture_count()), 1),
        before_(MisfitOfNominal(model, part)) {}

  std::vector<std::string> Run() {
    const RobotTree& tree = model_.robot.tree;
    std::vector<int> moving;  // coordinates that move
    for (int c = 0; c < tree.coordinate_count(); ++c) {
      const auto values = part_.q.col(c);
      if (values.maxCoeff() > values.minCoeff()) moving.push_back(c);
    }
    if (const auto cameras = CamerasAsBodies(model_, part_)) {
      TryConvention(*cameras);
      std::vector<std::string> found = Found();
      if (!found.empty()) return found;  // all others would begin with cameras rotated far
    }
    for (const int c : moving) TrySign(c);
    for (int rows = -kMostRowsOff; rows <= kMostRowsOff; ++rows) {
      if (rows != 0) TryShift(rows);
    }
    for (const WrittenConvention& convention : WrittenConventions(model_, part_)) {
      TryConvention(convention);
    }
    std::vector<std::string> found = Found();
    if (!found.empty()) return found;
    for (const WrittenConvention& convention : TagsInOtherUnits(model_, part_)) {
      TryConvention(convention);
    }
    for (const MeasuredBy& of : SeveralAlike(model_, part_)) {
      for (const WrittenConvention& convention : WrittenConventions(model_, part_, of)) {
        TryConvention(convention);
      }
    }
    found = Found();
    if (!found.empty()) return found;
    for (std::size_t a = 0; a < moving.size(); ++a) {  // hundreds for a humanoid
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
                      ShareOf(MisfitOfNominal(model_, undone).squares, before_.squares)});
  }

  /// Tries a convention. For tags and inertial units the mounting counts, too: a wrong convention
  /// rotates it far.
  void TryConvention(const WrittenConvention& convention) {
    const ObservedRobot& robot = convention.robot ? *convention.robot : model_;
    const ObservedMisfit after = MisfitOfNominal(robot, convention.undone);
    const double share = convention.turns_mountings ? ShareOf(after.squares + after.turned,
                                                              before_.squares + before_.turned)
                                                    : ShareOf(after.squares, before_.squares);
    const auto in_words = [&](const std::string& what, const std::string& right) {
      return what + where_ + ": " + right + " was expected";
    };
    tried_.push_back(
        {in_words(convention.what, convention.right), share,
         convention.family.empty() ? "" : in_words(convention.family, convention.right)});
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
                     [](const auto& a, const auto& b) { return a.left < b.left; });
    std::vector<const TriedMistake*> best;
    for (const TriedMistake& one : tried_) {
      if (!(one.left <= kLeftWithout)) break;
      if (one.left > kNearTheBest * tried_.front().left) break;
      best.push_back(&one);
    }
    std::vector<std::string> found;
    for (const TriedMistake* one : best) {
      const auto related = std::count_if(best.begin(), best.end(), [&](const TriedMistake* other) {
        return !one->family.empty() && other->family == one->family;
      });
      const std::string& what = related > 1 ? one->family : one->what;
      if (std::find(found.begin(), found.end(), what) == found.end()) found.push_back(what);
    }
    return found;
  }

  const ObservedRobot& model_;
  const Observations& part_;
  std::string name_, where_;
  std::vector<char> all_;
  ObservedMisfit before_;
  std::vector<TriedMistake> tried_;
};

/// The first posture that the nominal robot, placed by the postures before it, does not explain;
/// nothing where the first postures are no better than all.
std::optional<int> FirstUnexplained(const ObservedRobot& model, const Observations& of_file) {
  const int count = of_file.posture_count();
  const double all = MisfitOfNominal(model, of_file).squares;
  for (int share = 2; count / share >= kFewestRowsTried; ++share) {
    const Observations first = SelectPostures(of_file, Rows(0, count / share));
    const ObservedValues placed = PlacedAmong(model, first);
    if (SquaresOf(model, first, placed) > kLeftWithout * all) continue;
    std::vector<double> logs;  // logarithms of the residuals of each posture
    for (int i = 0; i < count; ++i) {
      logs.push_back(
          std::log(std::max(1e-12, SquaresOf(model, SelectPostures(of_file, {i}), placed))));
    }
    std::vector<double> sum = {0.0};
    for (const double of : logs) sum.push_back(sum.back() + of);
    int best = 0;
    double most = 0.0;  // largest step between two means, in units of its standard error
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

/// Finds a few rows that contradict all others, and would hide or imitate every other mistake.
/// Without them the nominal robot explains its observations.
std::vector<std::string> FindFarRows(const ObservedRobot& model, const Observations& all) {
  constexpr int kMost = 3, kOneIn = 10;
  constexpr double kFar = 25.0;  // times the median of the squares
  const int count = all.posture_count();
  if (count < 2 * kFewestRowsTried) return {};
  const ObservedValues placed = PlacedAmong(model, all);
  std::vector<double> squares;
  for (const int i : Rows(0, count)) {
    squares.push_back(SquaresOf(model, SelectPostures(all, {i}), placed));
  }
  const double far = kFar * Median(squares);
  std::vector<int> kept, off;
  for (const int i : Rows(0, count)) (squares[Size(i)] > far ? off : kept).push_back(i);
  const int most = std::min(kMost, count / kOneIn);
  if (off.empty() || static_cast<int>(off.size()) > most) return {};
  const Observations rest = SelectPostures(all, kept);
  const double left = SquaresOf(model, rest, PlacedAmong(model, rest));
  if (!(left <= kLeftWithout * SquaresOf(model, all, placed))) return {};
  std::vector<std::string> found;
  for (const int i : off) {
    const PosturePlace& place = all.postures[Size(i)];
    found.push_back(Place(all.files[Size(place.file)], place.line) +
                    "what the row shows contradicts all others: correct it (a plate, a tag, a "
                    "session of another row?) or take it out");
  }
  return found;
}

/// Finds mistakes in one file: in all its rows, or from one row on.
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
  std::vector<std::string> found = FindTwoTables(model, observations);
  if (found.empty()) found = FindFarRows(model, observations);
  if (found.empty()) found = MistakeSearch(model, observations, "", "").Run();
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
    files.push_back(
        {NameInAccept(observations.files[f]), of_file, MisfitOfNominal(model, of_file).squares});
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
