// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/given_motion.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/math/input_error.hpp"
#include "elastocal/simulation/motion_writer.hpp"
#include "elastocal/simulation/stream_seed.hpp"

namespace elastocal {
namespace {

constexpr double kStill = 1e-9;      // rad or m between samples
constexpr double kMoves = 1e-3;      // rad or m over a stretch: a smaller change is rounding
constexpr double kLeastRest = 0.3;   // s: shorter rests are turning points
constexpr double kFeetApart = 2e-3;  // m: tolerance of the floor and the soles ...
constexpr double kFeetTurn = 0.01;   // ... and rad

std::string PlaceOf(const JointMotion& motion, int sample) {
  return motion.line.empty() ? motion.source + ": "
                             : motion.source + ":" + std::to_string(motion.line[sample]) + ": ";
}

void MoveToFront(int foot, std::vector<int>& support) {
  const auto at = std::find(support.begin(), support.end(), foot);
  std::rotate(support.begin(), at, at + 1);
}

/// Samples [first, last] during which the same feet stand.
struct Stretch {
  int first = 0, last = 0;
  std::vector<int> support;
};

class GivenMotionPlanner {
 public:
  GivenMotionPlanner(const RobotTree& tree, const std::vector<NamedChain>& chains,
                     const JointMotion& motion, const MotionOptions& options,
                     const GivenMotionOptions& given)
      : tree_(tree),
        chains_(chains),
        motion_(motion),
        options_(options),
        given_(given),
        legs_(FindLegs(tree, chains)),
        q_(motion.q) {
    const PostureSampler sampler(tree, legs_, options.postures, StreamSeed(options.seed, "stand"));
    for (Eigen::Index c = 0; c < q_.cols(); ++c) {
      if (q_.col(c).array().isNaN().any()) q_.col(c).setConstant(sampler.stand()[c]);
    }
  }

  std::vector<PlannedTrial> Plan() const {
    const std::vector<Stretch> stretches = Stretches();
    std::vector<PlannedTrial> trials;
    std::vector<int> stayed;  // feet that have stood since the trial before
    for (const Stretch& stretch : stretches) {
      CheckFeet(stretch);
      std::erase_if(stayed, [&](int foot) { return !Contains(stretch.support, foot); });
      PlannedTrial trial;
      trial.name = given_.name;
      if (stretches.size() > 1) trial.name += "_" + std::to_string(trials.size() + 1);
      trial.support = stretch.support;
      trial.chains = given_.chains.empty() ? MovingChains(stretch) : given_.chains;
      if (trial.chains.empty()) continue;  // only standing legs move: the weight is shifted
      if (motion_.time_s.size() == 0) {
        VisitPostures(stretch, trial);
      } else {
        FollowSamples(stretch, trial);
      }
      if (motion_.time_s.size() > 0) StayOn(stayed, trials, trial);
      stayed = stretch.support;
      trial.kind =
          given_.kind.value_or(trial.postures > 0 ? TrialKind::kCalibration : TrialKind::kSine);
      trials.push_back(std::move(trial));
    }
    if (trials.empty()) {
      throw InputError(PlaceOf(motion_, 0) +
                       "no chain of the project moves from here on while the support is the same");
    }
    return trials;
  }

 private:
  std::vector<Stretch> Stretches() const {
    std::vector<int> feet;
    for (const Leg& leg : legs_) feet.push_back(leg.foot_link);
    std::vector<Stretch> stretches;
    for (int i = 0; i < motion_.sample_count(); ++i) {
      const std::vector<int>& support = motion_.support.empty() ? feet : motion_.support[i];
      if (!stretches.empty() && stretches.back().support == support) {
        stretches.back().last = i;
      } else {
        stretches.push_back({i, i, support});
      }
    }
    return stretches;
  }

  void CheckFeet(const Stretch& stretch) const {
    if (stretch.support.size() < 2) return;
    std::vector<Transform> first;
    for (int i = stretch.first; i <= stretch.last; ++i) {
      const std::vector<Transform> T_root_link = LinkTransforms(tree_, q_.row(i).transpose());
      for (std::size_t s = 1; s < stretch.support.size(); ++s) {
        const Transform T =
            T_root_link[stretch.support[0]].inverse() * T_root_link[stretch.support[s]];
        if (i == stretch.first) first.push_back(T);
        const Transform moved = first[s - 1].inverse() * T;
        const bool balls = IsBall(stretch.support[0]) || IsBall(stretch.support[s]);
        const double apart =
            balls ? std::abs(T.translation().norm() - first[s - 1].translation().norm())
                  : moved.translation().norm();
        if (apart < kFeetApart && (balls || RotationAngle(moved.linear()) < kFeetTurn)) continue;
        throw InputError(PlaceOf(motion_, i) + "the foot '" + tree_.links[stretch.support[s]].name +
                         "' is " + std::to_string(std::lround(1e3 * apart)) +
                         " mm from where it stood, against '" +
                         tree_.links[stretch.support[0]].name +
                         "': both cannot be on the floor; the column 'support' says which one is");
      }
    }
  }

  /// Keeps a foot in its place if it stands through two trials, because the robot plays the motion
  /// without a break. It becomes the first foot of both trials, which is the one that is flat on
  /// the floor. If another foot of the trial before stays already, this one cannot, because the
  /// robot's errors put it elsewhere.
  void StayOn(const std::vector<int>& feet, std::vector<PlannedTrial>& trials,
              PlannedTrial& trial) const {
    for (int foot : feet) {
      PlannedTrial& before = trials.back();
      if (IsBall(foot) || (before.stays && before.support[0] != foot)) continue;
      MoveToFront(foot, before.support);
      MoveToFront(foot, trial.support);
      trial.stays = true;
      return;
    }
  }

  static bool Contains(const std::vector<int>& links, int link) {
    return std::find(links.begin(), links.end(), link) != links.end();
  }

  bool IsBall(int link) const {
    return std::any_of(given_.soles.begin(), given_.soles.end(), [&](const Sole& sole) {
      return sole.link == link && sole.ball_radius.has_value();
    });
  }

  bool Moves(int coordinate, const Stretch& stretch) const {
    const auto q = q_.col(coordinate).segment(stretch.first, stretch.last - stretch.first + 1);
    return q.maxCoeff() - q.minCoeff() > kMoves;
  }

  bool MovesJoint(const Joint& joint, const Stretch& stretch) const {
    const std::vector<Drive> drives = DrivesOf(joint);
    return std::any_of(drives.begin(), drives.end(),
                       [&](const Drive& drive) { return Moves(drive.coordinate, stretch); });
  }

  std::vector<int> MovingChains(const Stretch& stretch) const {
    std::vector<int> moving;
    for (std::size_t c = 0; c < chains_.size(); ++c) {
      const NamedChain& chain = chains_[c];
      const auto& support = stretch.support;
      if (chain.from_link != 0 ||
          std::find(support.begin(), support.end(), chain.tip_link) != support.end()) {
        continue;
      }
      const std::vector<int> joints = JointsToBody(tree_, tree_.links[chain.tip_link].body);
      if (std::any_of(joints.begin(), joints.end(),
                      [&](int k) { return MovesJoint(tree_.joints[k], stretch); })) {
        moving.push_back(static_cast<int>(c));
      }
    }
    return moving;
  }

  Eigen::VectorXd Row(int i) const { return q_.row(i).transpose(); }

  void VisitPostures(const Stretch& stretch, PlannedTrial& trial) const {
    MotionWriter writer(Row(stretch.first), options_);
    writer.Rest(options_.rest_s);
    for (int i = stretch.first + 1; i <= stretch.last; ++i) writer.Visit({Row(i)});
    trial.motion = writer.motion;
    trial.postures = stretch.last - stretch.first + 1;
  }

  /// Turns runs of the same posture into rests, and the samples between them into segments.
  void FollowSamples(const Stretch& stretch, PlannedTrial& trial) const {
    if (stretch.first == stretch.last) {
      throw InputError(PlaceOf(motion_, stretch.first) +
                       "one sample alone with this support; two or more were expected");
    }
    MotionWriter writer(Row(stretch.first), options_);
    for (int i = stretch.first; i < stretch.last;) {
      int end = i + 1;
      const bool still = Still(i);
      while (end < stretch.last && Still(end) == still) ++end;
      const double duration = motion_.time_s[end] - motion_.time_s[i];
      if (still) {
        writer.Rest(duration);
        if (duration >= kLeastRest) ++trial.postures;
      } else {
        writer.Follow(motion_.time_s.segment(i, end - i + 1), q_.middleRows(i, end - i + 1));
      }
      i = end;
    }
    writer.Rest(options_.rest_s);
    trial.motion = writer.motion;
  }

  /// Whether nothing moves from this sample to the next.
  bool Still(int i) const { return (q_.row(i + 1) - q_.row(i)).cwiseAbs().maxCoeff() < kStill; }

  const RobotTree& tree_;
  const std::vector<NamedChain>& chains_;
  const JointMotion& motion_;
  const MotionOptions& options_;
  const GivenMotionOptions& given_;
  std::vector<Leg> legs_;
  Eigen::MatrixXd q_;
};

}  // namespace

std::vector<PlannedTrial> PlanGivenMotion(const RobotTree& tree,
                                          const std::vector<NamedChain>& chains,
                                          const JointMotion& motion, const MotionOptions& options,
                                          const GivenMotionOptions& given) {
  return GivenMotionPlanner(tree, chains, motion, options, given).Plan();
}

}  // namespace elastocal
