// SPDX-License-Identifier: Apache-2.0
#include "elastocal/motion/plan.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/parallel.hpp"
#include "elastocal/motion/move_builder.hpp"
#include "elastocal/motion/order.hpp"

namespace elastocal {
namespace {

/// Joins the rows of stretches, one behind the other.
class Rows {
 public:
  int count = 0;

  void Add(const Eigen::MatrixXd& q, const std::vector<int>& standing) {
    Add(q, std::vector<std::vector<int>>(Size(q.rows()), standing));
  }

  void Add(const Eigen::MatrixXd& q, const std::vector<std::vector<int>>& standing) {
    parts_.push_back(q);
    standing_.insert(standing_.end(), standing.begin(), standing.end());
    count += static_cast<int>(q.rows());
  }

  SampledMotion Join(double rate_hz, Eigen::Index columns) const {
    SampledMotion motion{rate_hz, Eigen::MatrixXd(count, columns), standing_};
    Eigen::Index row = 0;
    for (const Eigen::MatrixXd& part : parts_) {
      motion.q.middleRows(row, part.rows()) = part;
      row += part.rows();
    }
    return motion;
  }

 private:
  std::vector<Eigen::MatrixXd> parts_;
  std::vector<std::vector<int>> standing_;
};

/// Plans the tour through the postures of a set.
class TourPlanner {
 public:
  TourPlanner(const StandingRobot& robot, const PostureTour& set, const PlanOptions& options)
      : robot_(robot),
        set_(set),
        options_(SizedOptions(robot, options)),
        build_(robot, options_),
        here_{robot.rest, robot.T_world_root} {
    result_.name = set.name;
  }

  PlannedTour Plan() {
    Refusal why;
    if (StepOntoFeet(why)) {
      result_.begin = rows_.count;
      hub_ = here_;
      Hold();
      Tour();
      for (const int coordinate : set_.sines) Sine(coordinate);
      result_.end = rows_.count;
      StepBack();
    } else {
      for (int i = 0; i < static_cast<int>(set_.postures.size()); ++i) LeaveOut(i, why, false);
    }
    result_.motion = rows_.Join(options_.rate_hz, robot_.rest.size());
    return std::move(result_);
  }

 private:
  bool LiftsAFoot() const { return set_.standing.size() < robot_.soles.size(); }

  void Hold() {
    // The holds at the ends of moves are part of `hold_s`.
    const Eigen::Index samples = build_.SamplesOf(std::max(0.0, options_.hold_s - 1.0));
    rows_.Add(here_.q.transpose().replicate(samples, 1), set_.standing);
  }

  /// Shifts the weight and lifts the foot on which the set does not stand. The waist is upright, or
  /// leans if the hips do not bend so far. Does nothing if the set stands on all feet.
  bool StepOntoFeet(Refusal& why) {
    if (!LiftsAFoot()) return true;
    bool joint_at_end = false;
    for (const double lean : kRootTilts) {
      Refusal flat, tilted;
      if (StepLeaning(lean, flat, tilted)) return true;
      if (lean == 0.0) {
        joint_at_end = flat.constraint == Constraint::kPosition;
        why = joint_at_end && tilted.constraint != Constraint::kPosition ? tilted : flat;
      }
      if (!joint_at_end) return false;
    }
    return false;
  }

  /// Shifts the weight with a leaning waist and lifts the foot. If this fails, `why` is the reason
  /// with a flat foot. `tilted` is the reason with a tilted foot, if the flat foot fails at the end
  /// of a joint's range and the tilted one for another reason; otherwise it is equal to `why`.
  bool StepLeaning(double lean, Refusal& why, Refusal& tilted) {
    PlacedPosture over = here_;
    over.T_world_root.linear() = RotX(lean).linear() * over.T_world_root.linear();
    if (options_.balanced &&
        !BalanceAtRest(robot_, robot_.AllFeet(), build_.HandOver(set_.standing), over)) {
      why = tilted = OutOfReach();
      return false;
    }
    const auto shifted = build_.Shift(here_, over, set_.standing, why);
    tilted = why;
    if (!shifted) return false;
    shifted_ = *shifted;
    // The foot is flat or, if the ankle does not bend so far, has the toes, the heel or a side
    // down.
    constexpr std::array<double, 8> kTilts = {0.1, -0.1, 0.2, -0.2, 0.3, -0.3, 0.45, -0.45};
    if (LiftFoot(over, Eigen::Vector2d::Zero(), why)) return true;
    tilted = why;
    for (const Eigen::Vector2d axis : {Eigen::Vector2d::UnitY(), Eigen::Vector2d::UnitX()}) {
      for (const double tilt : kTilts) {
        Refusal refusal;
        if (LiftFoot(over, tilt * axis, refusal)) return true;
        if (refusal.constraint != Constraint::kPosition &&
            tilted.constraint == Constraint::kPosition) {
          tilted = refusal;
        }
      }
    }
    return false;
  }

  /// Lifts the foot on which the set does not stand, while the weight is over the others. `tilt` is
  /// a rotation vector about the x and y axes of the sole, rad.
  bool LiftFoot(const PlacedPosture& over, const Eigen::Vector2d& tilt, Refusal& why) {
    const int swings = SwingingFoot();
    const Transform T_world_lifted = Eigen::Translation3d(0.0, 0.0, options_.lift_m) *
                                     TiltedSole(robot_.T_world_sole[Size(swings)], tilt);
    const auto up = build_.AtRestWithFoot(set_.standing, swings, T_world_lifted, over, why);
    if (!up) return false;
    const auto lifted = build_.Lift(over, *up, set_.standing, swings, tilt, why);
    if (!lifted) return false;
    lifted_ = *lifted;
    rows_.Add(shifted_, robot_.AllFeet());
    rows_.Add(lifted_, set_.standing);
    here_ = *up;
    return true;
  }

  int SwingingFoot() const {
    const std::vector<int> all = robot_.AllFeet();
    return *std::find_if(all.begin(), all.end(), [&](int foot) {
      return std::find(set_.standing.begin(), set_.standing.end(), foot) == set_.standing.end();
    });
  }

  void StepBack() {
    if (!LiftsAFoot()) return;
    rows_.Add(lifted_.colwise().reverse(), set_.standing);
    rows_.Add(shifted_.colwise().reverse(), robot_.AllFeet());
  }

  void LeaveOut(int posture, const Refusal& why, bool at_rest) {
    result_.left_out.push_back({posture, -1, why.constraint, why.value, why.index, at_rest});
  }

  void Tour() {
    for (const int i : Order()) {
      Refusal why;
      if (set_.in_order) GoTo(hub_, why);
      const Eigen::VectorXd& q = set_.postures[Size(i)];
      const auto target = set_.legs_given ? build_.AsGiven(q, set_.standing, why)
                                          : build_.AtRest(q, set_.standing, here_, why);
      if (!target) {
        LeaveOut(i, why, true);
      } else if (!(set_.approaches.empty() ? VisitDirectly(i, *target, why)
                                           : VisitByApproach(i, *target, why))) {
        LeaveOut(i, why, false);
      }
    }
    GoBack();
  }

  bool VisitDirectly(int posture, const PlacedPosture& target, Refusal& why) {
    if (!GoTo(target, why) && !GoByHub(target, why)) return false;
    Rest(posture);
    return true;
  }

  bool VisitByApproach(int posture, const PlacedPosture& target, Refusal& why) {
    const Eigen::MatrixXd& way = set_.approaches[Size(posture)];
    if (way.rows() == 0) {
      why = {Constraint::kApproach};
      return false;
    }
    const PlacedPosture before{WithLegsOf(target.q, way.row(0).transpose()), target.T_world_root};
    const auto there = build_.Follow(before, target, set_.standing, way, why);
    if (!there || (!GoTo(before, why) && !GoByHub(before, why))) return false;
    rows_.Add(*there, set_.standing);
    here_ = target;
    Rest(posture);
    rows_.Add(there->colwise().reverse(), set_.standing);
    here_ = before;
    return true;
  }

  /// Holds the posture in which the robot has arrived, and records it as visited.
  void Rest(int posture) {
    const int ends = static_cast<int>(build_.SamplesOf(0.5));
    result_.visits.push_back({posture, rows_.count - ends, 0});
    Hold();
    result_.visits.back().end = rows_.count + ends;
  }

  std::vector<int> Order() const {
    if (!set_.in_order) return OrderPostures(hub_.q, Targets());
    std::vector<int> order(set_.postures.size());
    std::iota(order.begin(), order.end(), 0);
    return order;
  }

  /// Adds the largest sine of a coordinate that keeps the limits.
  void Sine(int coordinate) {
    constexpr double kSmaller = 0.8;
    Refusal why;
    double share = options_.sine.share;
    while (share >= options_.sine.least_share) {
      const auto sine = build_.Sine(hub_, set_.standing, coordinate, share, why);
      if (sine) {
        rows_.Add(*sine, set_.standing);
        return;
      }
      share *= kSmaller;
    }
    result_.left_out.push_back({-1, coordinate, why.constraint, why.value, why.index, false});
  }

  /// The postures with the joints of standing legs as in the hub, so that these do not affect the
  /// order.
  std::vector<Eigen::VectorXd> Targets() const {
    std::vector<Eigen::VectorXd> targets;
    for (const Eigen::VectorXd& q : set_.postures) targets.push_back(WithLegsOf(hub_.q, q));
    return targets;
  }

  /// The posture with the joints of standing legs as they are in another one.
  Eigen::VectorXd WithLegsOf(const Eigen::VectorXd& other, Eigen::VectorXd q) const {
    for (const int foot : set_.standing) {
      for (const int c : robot_.legs[Size(foot)].coordinates()) q[c] = other[c];
    }
    return q;
  }

  bool GoTo(const PlacedPosture& to, Refusal& why) {
    if (to.q == here_.q) return true;
    const auto move = build_.Move(here_, to, set_.standing, why);
    if (!move) return false;
    rows_.Add(*move, set_.standing);
    moves_.push_back(*move);
    before_.push_back(here_);
    here_ = to;
    return true;
  }

  bool GoByHub(const PlacedPosture& to, Refusal& why) {
    return here_.q != hub_.q && GoTo(hub_, why) && GoTo(to, why);
  }

  /// Moves to the hub. If there is no way, goes back on the moves made so far until there is one.
  void GoBack() {
    Refusal why;
    while (!GoTo(hub_, why) && !moves_.empty()) {
      rows_.Add(moves_.back().colwise().reverse(), set_.standing);
      here_ = before_.back();
      moves_.pop_back();
      before_.pop_back();
    }
    Hold();
  }

  const StandingRobot& robot_;
  const PostureTour& set_;
  const PlanOptions options_;
  MoveBuilder build_;
  PlacedPosture here_, hub_;
  Eigen::MatrixXd shifted_, lifted_;
  Rows rows_;
  std::vector<Eigen::MatrixXd> moves_;  // since the hub
  std::vector<PlacedPosture> before_;   // the posture in which each began
  PlannedTour result_;
};

}  // namespace

PlannedTour PlanTour(const StandingRobot& robot, const PostureTour& set,
                     const PlanOptions& options) {
  return TourPlanner(robot, set, options).Plan();
}

std::vector<PlannedTour> PlanTours(const StandingRobot& robot, const std::vector<PostureTour>& sets,
                                   const PlanOptions& options, int threads,
                                   const Progress& progress) {
  std::vector<PlannedTour> planned(sets.size());
  ForAll(
      sets.size(), threads, [&](std::size_t i) { planned[i] = PlanTour(robot, sets[i], options); },
      progress);
  return planned;
}

SampledMotion JoinMotions(const StandingRobot& robot, const std::vector<PlannedTour>& sets,
                          double lead_in_s, double rate_hz) {
  Rows rows;
  rows.Add(robot.rest.transpose().replicate(std::lround(lead_in_s * rate_hz) + 1, 1),
           robot.AllFeet());
  for (const PlannedTour& set : sets) rows.Add(set.motion.q, set.motion.standing);
  return rows.Join(rate_hz, robot.rest.size());
}

}  // namespace elastocal
