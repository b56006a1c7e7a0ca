// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/motions.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/smooth_step.hpp"
#include "elastocal/simulation/motion_writer.hpp"
#include "elastocal/simulation/stream_seed.hpp"

namespace elastocal {
namespace {

/// Slope of the samples at sample i; one-sided at the ends.
Eigen::VectorXd SlopeAt(const MotionSegment& segment, Eigen::Index i) {
  const Eigen::Index before = std::max<Eigen::Index>(0, i - 1);
  const Eigen::Index after = std::min<Eigen::Index>(segment.sample_s.size() - 1, i + 1);
  return (segment.samples.row(after) - segment.samples.row(before)).transpose() /
         (segment.sample_s[after] - segment.sample_s[before]);
}

Eigen::VectorXd AlongSamples(const MotionSegment& segment, double time_s) {
  const Eigen::VectorXd& times = segment.sample_s;
  time_s = std::clamp(time_s, times[0], times[times.size() - 1]);
  const auto next = std::upper_bound(times.begin() + 1, times.end() - 1, time_s);
  const auto i = static_cast<Eigen::Index>(next - times.begin()) - 1;
  const double step = times[i + 1] - times[i];
  const double s = (time_s - times[i]) / step;
  const double r = 1.0 - s;
  return r * r * (1.0 + 2.0 * s) * segment.samples.row(i).transpose() +
         s * s * (1.0 + 2.0 * r) * segment.samples.row(i + 1).transpose() +
         step * s * r * (r * SlopeAt(segment, i) - s * SlopeAt(segment, i + 1));
}

Eigen::VectorXd Evaluate(const MotionSegment& segment, double time_s) {
  if (segment.sample_s.size() > 0) return AlongSamples(segment, time_s);
  if (segment.coordinate < 0) {
    return segment.from + SmoothStep(time_s / segment.duration_s) * (segment.to - segment.from);
  }
  // One period is used to swing in from the posture, and one to come back.
  const double ramp = 1.0 / segment.frequency_hz;
  const double share = SmoothStep(time_s / ramp) * SmoothStep((segment.duration_s - time_s) / ramp);
  Eigen::VectorXd q = segment.from;
  const double sine = segment.amplitude * std::sin(2.0 * M_PI * segment.frequency_hz * time_s);
  q[segment.coordinate] += share * (segment.centre - q[segment.coordinate] + sine);
  return q;
}

/// Orders postures by going to the nearest one not yet visited (section 3.6).
std::vector<Eigen::VectorXd> Sorted(const Eigen::VectorXd& start,
                                    std::vector<Eigen::VectorXd> postures) {
  const Eigen::VectorXd* here = &start;
  for (std::size_t i = 0; i < postures.size(); ++i) {
    const auto next =
        std::min_element(postures.begin() + static_cast<std::ptrdiff_t>(i), postures.end(),
                         [&](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
                           return (a - *here).squaredNorm() < (b - *here).squaredNorm();
                         });
    std::iter_swap(postures.begin() + static_cast<std::ptrdiff_t>(i), next);
    here = &postures[i];
  }
  return postures;
}

class Planner {
 public:
  Planner(const RobotTree& tree, const std::vector<NamedChain>& chains,
          const MotionOptions& options)
      : tree_(tree), chains_(chains), options_(options), legs_(FindLegs(tree, chains)) {
    if (!Sampler("stand").stands()) legs_.clear();
    for (const Leg& leg : legs_) feet_.push_back(leg.foot_link);
    for (std::size_t c = 0; c < chains.size(); ++c) {
      const NamedChain& chain = chains[c];
      const bool foot = std::find(feet_.begin(), feet_.end(), chain.tip_link) != feet_.end();
      if (!foot && chain.from_link == 0 && chain.tip_link != 0) {
        upper_.push_back(static_cast<int>(c));
      }
    }
  }

  std::vector<PlannedTrial> Plan() {
    for (int chain : upper_) UpperCalibration(chain);
    for (std::size_t i = 0; i < legs_.size(); ++i) LegCalibration(i);
    if (!upper_.empty()) {
      UpperSine();
      UpperRandom();
      UpperRepeatability();
    }
    for (std::size_t i = 0; i < legs_.size(); ++i) LegValidation(i);
    return std::move(trials_);
  }

 private:
  PostureSampler Sampler(const std::string& trial) const {
    return {tree_, legs_, options_.postures, StreamSeed(options_.seed, trial)};
  }

  void Add(const std::string& name, TrialKind kind, const std::vector<int>& chains,
           const std::vector<int>& support, Motion motion, int postures) {
    trials_.push_back({name, kind, chains, support, std::move(motion), postures});
  }

  int JointCount(const NamedChain& chain) const {
    return static_cast<int>(JointsToBody(tree_, tree_.links[Size(chain.tip_link)].body).size());
  }

  void UpperCalibration(int c) {
    const NamedChain& chain = chains_[Size(c)];
    const bool arm = JointCount(chain) >= options_.postures.arm_joints;
    PostureSampler sampler = Sampler(chain.name);
    std::vector<Eigen::VectorXd> postures;
    for (int i = 0; i < (arm ? options_.arm_postures : options_.head_postures); ++i) {
      postures.push_back(sampler.DrawUpper(chain));
    }
    MotionWriter writer(sampler.stand(), options_);
    writer.Visit(Sorted(sampler.stand(), postures));
    Add(chain.name, TrialKind::kCalibration, {c}, feet_, writer.motion,
        static_cast<int>(postures.size()));
  }

  /// All chains of the upper body, each in a posture of its own.
  Eigen::VectorXd DrawUpperBody(PostureSampler& sampler) const {
    Eigen::VectorXd q = sampler.stand();
    for (int c : upper_) {
      const Eigen::VectorXd drawn = sampler.DrawUpper(chains_[Size(c)]);
      for (int k : JointsToBody(tree_, tree_.links[Size(chains_[Size(c)].tip_link)].body)) {
        q[tree_.joints[Size(k)].coordinate] = drawn[tree_.joints[Size(k)].coordinate];
      }
    }
    return q;
  }

  void UpperRandom() {
    PostureSampler sampler = Sampler("upper_random");
    std::vector<Eigen::VectorXd> postures;
    for (int i = 0; i < options_.random_postures; ++i) postures.push_back(DrawUpperBody(sampler));
    MotionWriter writer(sampler.stand(), options_);
    writer.Visit(Sorted(sampler.stand(), postures));
    Add("upper_random", TrialKind::kRandom, upper_, feet_, writer.motion, options_.random_postures);
  }

  void UpperRepeatability() {
    PostureSampler sampler = Sampler("upper_repeat");
    const Eigen::VectorXd reach = DrawUpperBody(sampler);
    MotionWriter writer(sampler.stand(), options_);
    for (int i = 0; i < options_.repetitions; ++i) writer.Visit({reach, sampler.stand()});
    Add("upper_repeat", TrialKind::kRepeatability, upper_, feet_, writer.motion,
        2 * options_.repetitions);
  }

  /// Largest sine of a joint around the middle of its range.
  std::pair<double, double> SineRange(int coordinate) const {
    const Joint& joint = tree_.joints[Size(tree_.coordinate_joint[Size(coordinate)])];
    const auto [lower, upper] = PostureRange(joint);
    const double by_speed =
        options_.speed_share * joint.limits.velocity / (2.0 * M_PI * options_.sine_hz);
    return {0.5 * (lower + upper), std::min(0.5 * options_.sine_share * (upper - lower), by_speed)};
  }

  void UpperSine() {
    const PostureSampler sampler = Sampler("upper_sine");
    MotionWriter writer(sampler.stand(), options_);
    std::set<int> moved;
    for (int c : upper_) {
      for (int k : JointsToBody(tree_, tree_.links[Size(chains_[Size(c)].tip_link)].body)) {
        const int coordinate = tree_.joints[Size(k)].coordinate;
        if (tree_.joints[Size(k)].mimic || !moved.insert(coordinate).second) continue;
        const auto [centre, amplitude] = SineRange(coordinate);
        writer.Sine(coordinate, centre, amplitude);
      }
    }
    writer.Rest(options_.rest_s);
    Add("upper_sine", TrialKind::kSine, upper_, feet_, writer.motion, 0);
  }

  Eigen::VectorXd DrawLeg(PostureSampler& sampler, std::size_t i) const {
    Eigen::VectorXd q = sampler.stand();
    if (options_.counterweight > 0.0) {
      q += options_.counterweight * (DrawUpperBody(sampler) - q);
    }
    return sampler.DrawSwing(q, legs_[i], Support(i));
  }

  const Leg& Support(std::size_t swing) const { return legs_[swing == 0 ? 1 : 0]; }

  int ChainOf(const Leg& leg) const {
    for (std::size_t c = 0; c < chains_.size(); ++c) {
      if (chains_[c].name == leg.chain) return static_cast<int>(c);
    }
    return 0;
  }

  void AddLegPostures(std::size_t i, const std::string& name, TrialKind kind, int count) {
    PostureSampler sampler = Sampler(name);
    std::vector<Eigen::VectorXd> postures;
    for (int n = 0; n < count; ++n) postures.push_back(DrawLeg(sampler, i));
    const Eigen::VectorXd start = DrawLeg(sampler, i);
    MotionWriter writer(start, options_);
    writer.Visit(Sorted(start, postures));
    Add(name, kind, {ChainOf(legs_[i])}, {Support(i).foot_link}, writer.motion, count);
  }

  void LegCalibration(std::size_t i) {
    if (legs_.size() < 2) return;
    AddLegPostures(i, legs_[i].chain, TrialKind::kCalibration, options_.leg_postures);
  }

  /// The largest sine of a leg's joint that stays above the floor and apart from the other leg.
  std::pair<double, double> LegSine(const PostureSampler& sampler, std::size_t i,
                                    const Eigen::VectorXd& q, int coordinate) const {
    constexpr int kChecks = 20;
    auto [centre, amplitude] = SineRange(coordinate);
    double share = 1.0;
    while (share > 0.05) {
      // As the sine shrinks, its middle moves to the posture, which is feasible.
      const double middle = q[coordinate] + share * (centre - q[coordinate]);
      bool feasible = true;
      for (int n = -kChecks; n <= kChecks && feasible; ++n) {
        Eigen::VectorXd moved = q;
        moved[coordinate] = middle + share * amplitude * n / kChecks;
        feasible = sampler.SwingFeasible(moved, legs_[i], Support(i));
      }
      if (feasible) return {middle, share * amplitude};
      share -= 0.05;
    }
    return {q[coordinate], 0.0};
  }

  void LegValidation(std::size_t i) {
    if (legs_.size() < 2) return;
    const std::string name = legs_[i].chain;
    LegSineTrial(i, name + "_sine");
    AddLegPostures(i, name + "_random", TrialKind::kRandom, options_.random_postures);

    PostureSampler sampler = Sampler(name + "_repeat");
    const Eigen::VectorXd first = DrawLeg(sampler, i);
    const Eigen::VectorXd second = DrawLeg(sampler, i);
    MotionWriter writer(first, options_);
    for (int n = 0; n < options_.repetitions; ++n) writer.Visit({second, first});
    Add(name + "_repeat", TrialKind::kRepeatability, {ChainOf(legs_[i])}, {Support(i).foot_link},
        writer.motion, 2 * options_.repetitions);
  }

  /// Writes a sine of each joint of the swinging leg in turn. Between two of them the support leg
  /// takes another posture.
  void LegSineTrial(std::size_t i, const std::string& name) {
    constexpr int kTries = 100;
    PostureSampler sampler = Sampler(name);
    MotionWriter writer(DrawLeg(sampler, i), options_);
    for (int k : legs_[i].joints) {
      if (tree_.joints[Size(k)].mimic) continue;
      const int coordinate = tree_.joints[Size(k)].coordinate;
      for (int n = 0; n < kTries; ++n) {
        const auto next = sampler.DrawSupport(writer.here(), legs_[i], Support(i));
        if (!next) continue;
        writer.MoveTo(*next);
        break;
      }
      const auto [centre, amplitude] = LegSine(sampler, i, writer.here(), coordinate);
      writer.Sine(coordinate, centre, amplitude);
    }
    writer.Rest(options_.rest_s);
    Add(name, TrialKind::kSine, {ChainOf(legs_[i])}, {Support(i).foot_link}, writer.motion, 0);
  }

  const RobotTree& tree_;
  const std::vector<NamedChain>& chains_;
  const MotionOptions& options_;
  std::vector<Leg> legs_;
  std::vector<int> feet_, upper_;
  std::vector<PlannedTrial> trials_;
};

}  // namespace

double Motion::duration_s() const {
  double duration = 0.0;
  for (const MotionSegment& segment : segments) duration += segment.duration_s;
  return duration;
}

Eigen::VectorXd PostureAt(const Motion& motion, double time_s) {
  for (const MotionSegment& segment : motion.segments) {
    if (time_s < segment.duration_s) return Evaluate(segment, std::max(0.0, time_s));
    time_s -= segment.duration_s;
  }
  const MotionSegment& last = motion.segments.back();
  return Evaluate(last, last.duration_s);
}

std::vector<PlannedTrial> PlanTrials(const RobotTree& tree, const std::vector<NamedChain>& chains,
                                     const MotionOptions& options) {
  return Planner(tree, chains, options).Plan();
}

}  // namespace elastocal
