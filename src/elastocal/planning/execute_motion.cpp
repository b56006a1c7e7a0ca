// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/execute_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/parallel.hpp"
#include "elastocal/planning/root_watch.hpp"
#include "elastocal/planning/simulate_experiment.hpp"
#include "elastocal/tables/json_text.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kBeforeLanding = 0.05;  // s
constexpr int kEvery = 10;               // looks (of 10 ms) between two comparisons
constexpr double kLook = 0.01;           // s
constexpr int kPictureEvery = 20;        // looks between two pictures, at least
constexpr int kMostPictures = 2000;

/// Looks between two pictures: a multiple of `kEvery`, larger for a long motion.
int LooksAPicture(const JointMotion& plan) {
  const double duration = plan.time_s[plan.time_s.size() - 1] - plan.time_s[0];
  const double fewest = duration / kLook / kMostPictures;
  return std::max(kPictureEvery, kEvery * static_cast<int>(std::ceil(fewest / kEvery)));
}

/// Compares the robot's poses with those of the plan.
class PlanWatch {
 public:
  /// `model`: for the limbs.
  PlanWatch(const Project& project, const RuntimeModel& model, const TrueRobot& robot,
            const JointMotion& plan, RootWatch root)
      : project_(project),
        robot_(robot),
        plan_(plan),
        looks_a_picture_(LooksAPicture(plan)),
        root_(std::move(root)) {
    for (std::size_t t = 0; t < model.tips.size(); ++t) {
      const Chain& chain = project.chains[Size(FindChain(project, model.tip_names[t]))];
      const bool is_foot = std::ranges::count(project.soles, chain.tip_link, &Sole::link) > 0;
      if (!is_foot && IsArm(model, t)) hands_links_.push_back(chain.tip_link);
    }
    MarkLandings();
    std::vector<PlaybackTip> tips;
    for (int link : hands_links_) tips.push_back({.link = link});
    for (const Sole& sole : project.soles) tips.push_back({.link = sole.link, .is_foot = true});
    recorder_.emplace(project.tree, std::move(tips));
  }

  void Look(Eigen::Index sample, const Eigen::VectorXd& planned, const VirtualRobot& body) {
    const int landing = landing_[static_cast<std::size_t>(sample)];
    const bool lands = landing >= 0 && landing != last_landing_;
    if (++looks_ % kEvery != 0 && !lands) return;
    const std::vector<int>& support = plan_.support[static_cast<std::size_t>(sample)];
    const std::vector<Transform> T_root_link = LinkTransforms(project_.tree, planned);
    const Transform T_wanted = T_root_link[static_cast<std::size_t>(support.front())].inverse();
    const Transform T_got = SolePose(support.front(), body).inverse();
    if (lands) {
      last_landing_ = landing;
      const int link = landing_link_[static_cast<std::size_t>(landing)];
      landing_sum_.Add(T_wanted * T_root_link[static_cast<std::size_t>(link)],
                       T_got * SolePose(link, body));
    }
    if (looks_ % kEvery != 0) return;
    root_.Look(support, body);
    for (int link : hands_links_) {
      hands_.Add(T_wanted * T_root_link[static_cast<std::size_t>(link)],
                 T_got * body.LinkPose(link));
    }
    for (const Sole& sole : project_.soles) {
      if (std::count(support.begin(), support.end(), sole.link) > 0) continue;
      feet_.Add(T_wanted * T_root_link[static_cast<std::size_t>(sole.link)],
                T_got * SolePose(sole.link, body));
    }
    waist_.Add(T_wanted, T_got * body.WaistPose());
    AddCentreOfMass(T_wanted, T_root_link, T_got, body);
    if (looks_ % looks_a_picture_ != 0) return;
    recorder_->Add(static_cast<double>(looks_) * kLook, planned, T_root_link, support,
                   LinkPoses(body));
  }

  const Playback& playback() const { return recorder_->playback(); }

  void Store(Execution& execution) const {
    execution.hands = hands_.Result();
    execution.swinging_feet = feet_.Result();
    execution.landing = landing_sum_.Result();
    execution.waist = waist_.Result();
    execution.centre_of_mass = com_.Result();
    execution.root_on_one_foot = root_.on_one_foot();
    execution.root_on_several_feet = root_.on_several_feet();
  }

 private:
  /// Marks the sample shortly before each time at which the plan sets a foot down.
  void MarkLandings() {
    const std::size_t count = plan_.support.size();
    landing_.assign(count, -1);
    for (std::size_t i = 1; i < count; ++i) {
      for (int link : plan_.support[i]) {
        const std::vector<int>& before = plan_.support[i - 1];
        if (before.empty() || std::count(before.begin(), before.end(), link) > 0) continue;
        std::size_t early = i - 1;
        const auto time = [&](std::size_t at) {
          return plan_.time_s[static_cast<Eigen::Index>(at)];
        };
        while (early > 0 && time(i) - time(early) < kBeforeLanding) --early;
        landing_[early] = static_cast<int>(landing_link_.size());
        landing_link_.push_back(link);
      }
    }
  }

  Transform SolePose(int link, const VirtualRobot& body) const {
    for (std::size_t i = 0; i < project_.soles.size(); ++i) {
      if (project_.soles[i].link == link) return body.SolePose(static_cast<int>(i));
    }
    return body.LinkPose(link);
  }

  std::vector<Transform> LinkPoses(const VirtualRobot& body) const {
    std::vector<Transform> poses;
    for (std::size_t i = 0; i < project_.tree.links.size(); ++i) {
      poses.push_back(SolePose(static_cast<int>(i), body));
    }
    return poses;
  }

  void AddCentreOfMass(const Transform& T_wanted, const std::vector<Transform>& T_root_link,
                       const Transform& T_got, const VirtualRobot& body) {
    Eigen::Vector3d wanted = Eigen::Vector3d::Zero(), got = Eigen::Vector3d::Zero();
    double wanted_mass = 0.0, got_mass = 0.0;
    for (std::size_t i = 0; i < T_root_link.size(); ++i) {
      const Link& nominal = project_.tree.links[i];
      const Link& real = robot_.tree.links[i];
      wanted_mass += nominal.mass;
      wanted += nominal.mass * (T_root_link[i] * nominal.com);
      got_mass += real.mass;
      got += real.mass * (body.LinkPose(static_cast<int>(i)) * real.com);
    }
    com_.Add(
        (T_wanted * Eigen::Vector3d(wanted / wanted_mass) - T_got * Eigen::Vector3d(got / got_mass))
            .norm(),
        0.0);
  }

  const Project& project_;
  const TrueRobot& robot_;
  const JointMotion& plan_;
  std::vector<int> hands_links_, landing_, landing_link_;
  int last_landing_ = -1;
  long looks_ = 0;
  int looks_a_picture_;
  std::optional<PlaybackRecorder> recorder_;
  RootWatch root_;
  PlaceErrorSum hands_, feet_, landing_sum_, waist_, com_;
};

/// The motion with all feet on the floor, where it does not state the support.
JointMotion OnItsFeet(const Project& project, JointMotion motion) {
  if (project.soles.empty()) {
    throw InputError(
        project.file.string() +
        ": the robot has no feet; 'standing' with 'soles' was expected, since the robot "
        "that executes a motion stands freely");
  }
  if (!motion.support.empty()) return motion;
  std::vector<int> feet;
  for (const Sole& sole : project.soles) feet.push_back(sole.link);
  motion.support.assign(Size(motion.time_s.size()), feet);
  return motion;
}

void CheckPlan(const JointMotion& planned) {
  const bool stands = !planned.support.empty() &&
                      std::none_of(planned.support.begin(), planned.support.end(),
                                   [](const std::vector<int>& links) { return links.empty(); });
  if (planned.time_s.size() < 3 || !stands) {
    throw InputError(planned.source +
                     ": a motion with times and a foot on the floor in every sample was expected");
  }
}

/// The samples of the plan up to a time.
JointMotion Until(double time_s, JointMotion planned) {
  const auto after = std::upper_bound(planned.time_s.begin(), planned.time_s.end(), time_s);
  const Eigen::Index count = after - planned.time_s.begin();
  planned.time_s.conservativeResize(count);
  planned.q.conservativeResize(count, Eigen::NoChange);
  planned.support.resize(Size(count));
  planned.line.resize(std::min(planned.line.size(), Size(count)));
  return planned;
}

/// The part of a calibration that a controller knows.
RuntimeContent ContentOf(DeployAs as) {
  if (as == DeployAs::kNominal) return RuntimeContent::kNominal;
  return as == DeployAs::kUrdf ? RuntimeContent::kGeometry : RuntimeContent::kEverything;
}

/// The commands for the plan, or the reason why there are none.
struct Commanded {
  Eigen::MatrixXd q;
  std::string refused;
};

Commanded Commands(const Project& project, const StoredCalibration& calibration,
                   const JointMotion& planned, DeployAs as, MotionLoads loads) {
  if (as == DeployAs::kNominal) return {planned.q, ""};
  CompensatedMotion corrected = CompensateMotion(
      project, MakeRuntimeModel(project, calibration, ContentOf(as)), planned, {.loads = loads});
  return {std::move(corrected.planned.motion.q),
          corrected.broken.empty() ? "" : corrected.broken.front()};
}

/// Attitude that a controller with a calibration expects of the root link at the first rest on flat
/// soles: the planned one, because its commands compensate the errors. The controller of the
/// nominal robot takes the inertial unit as mounted by the robot description.
std::optional<Eigen::Matrix3d> CalibratedMounting(const Project& project,
                                                  const JointMotion& planned, DeployAs as) {
  if (as == DeployAs::kNominal) return std::nullopt;
  const std::vector<Transform> T_root_link =
      LinkTransforms(project.tree, planned.q.row(0).transpose());
  const int standing = planned.support.front().front();
  return T_root_link[static_cast<std::size_t>(standing)].linear().transpose();
}

/// Command with which a critically damped servo of this frequency follows q: the inverse of its
/// lag, by differences of the samples.
Eigen::MatrixXd FeedForward(const Eigen::MatrixXd& q, const Eigen::VectorXd& time_s,
                            double frequency, double lag_s) {
  Eigen::MatrixXd command = q;
  for (Eigen::Index i = 1; i + 1 < q.rows(); ++i) {
    const double step = 0.5 * (time_s[i + 1] - time_s[i - 1]);
    const Eigen::RowVectorXd speed = (q.row(i + 1) - q.row(i - 1)) / (2.0 * step);
    const Eigen::RowVectorXd change =
        (q.row(i + 1) - 2.0 * q.row(i) + q.row(i - 1)) / (step * step);
    command.row(i) += lag_s * speed + change / (frequency * frequency);
  }
  return command;
}

Json ErrorJson(const PlaceError& error) {
  constexpr double kDegreesARadian = 180.0 / M_PI;
  return {{"rms_mm", 1e3 * error.rms_m},
          {"max_mm", 1e3 * error.max_m},
          {"rms_deg", kDegreesARadian * error.rms_rad},
          {"max_deg", kDegreesARadian * error.max_rad},
          {"samples", error.samples}};
}

}  // namespace

const char* DeployName(DeployAs as) {
  constexpr std::array kNames = {"nominal", "urdf", "compensated"};
  return kNames[static_cast<std::size_t>(as)];
}

std::vector<Execution> PlayExecutions(const Project& project, const StoredCalibration& calibration,
                                      const JointMotion& motion, const DeployOptions& options,
                                      const Progress& progress) {
  constexpr double kHeld = 20.0;  // factor of stiffness that represents integrating servos
  const JointMotion given = OnItsFeet(project, motion);
  CheckPlan(given);
  const JointMotion planned = WithOpenJointsAtRest(project, Until(options.until_s, given));
  CheckPlan(planned);
  const DescribedRobot described = DescribeRobot(project);
  const TrueRobot robot = DrawTrueRobot(
      NominalRobot(described.tree, described.markers, FindLegs(described.tree, described.chains),
                   described.torque_sensors),
      options.truth);
  PhysicsOptions physics = options.physics;
  physics.servo_stiffness *= kHeld;
  physics.sliding_servo_stiffness *= kHeld;
  std::vector<Commanded> commands(options.as.size());
  ForAll(commands.size(), options.threads, [&](std::size_t i) {
    commands[i] = Commands(project, calibration, planned, options.as[i], options.loads);
    commands[i].q = FeedForward(commands[i].q, planned.time_s, physics.servo_frequency,
                                2.0 / physics.servo_frequency - physics.time_step_s);
  });
  const RuntimeModel limbs = MakeRuntimeModel(project, calibration, RuntimeContent::kNominal);
  const std::size_t runs = options.stabilised.size();  // runs of each robot
  std::vector<Execution> executions(runs * options.as.size());
  const auto play = [&](std::size_t i) {
    Execution& execution = executions[i];
    execution.as = options.as[i / runs];
    execution.stabilised = options.stabilised[i % runs];
    execution.refused = commands[i / runs].refused;
    if (!execution.refused.empty()) return;
    Stabiliser stabiliser(project.tree, project.soles);
    PlanWatch watch(project, limbs, robot, planned,
                    RootWatch(project, calibration, ContentOf(execution.as)));
    execution.run = StandThrough(
        robot, project.soles, planned, physics,
        {.stabiliser = execution.stabilised ? &stabiliser : nullptr,
         .R_world_root_at_rest = CalibratedMounting(project, planned, execution.as),
         .commanded = &commands[i / runs].q,
         .watch = [&](Eigen::Index sample, const Eigen::VectorXd& posture,
                      const VirtualRobot& body) { watch.Look(sample, posture, body); }});
    watch.Store(execution);
    // One run of each robot is shown.
    if (i % runs == 0) execution.playback = watch.playback();
  };
  ForAll(executions.size(), options.threads, play, progress);
  return executions;
}

std::string FormatExecutions(const RobotTree& tree, const std::string& calibration_fingerprint,
                             const std::vector<Execution>& executions) {
  Json json;
  json["calibration_fingerprint"] = calibration_fingerprint;
  json["executions"] = Json::array();
  std::vector<NamedPlayback> playbacks;
  for (const Execution& one : executions) {
    json["executions"].push_back({{"as", DeployName(one.as)},
                                  {"stabilised", one.stabilised},
                                  {"refused", one.refused},
                                  {"stood", one.run.stood},
                                  {"time_s", one.run.time_s},
                                  {"hands", ErrorJson(one.hands)},
                                  {"swinging_feet", ErrorJson(one.swinging_feet)},
                                  {"landing", ErrorJson(one.landing)},
                                  {"waist", ErrorJson(one.waist)},
                                  {"centre_of_mass", ErrorJson(one.centre_of_mass)},
                                  {"root_on_one_foot", ErrorJson(one.root_on_one_foot)},
                                  {"root_on_several_feet", ErrorJson(one.root_on_several_feet)},
                                  {"stabiliser_largest_shift_mm", 1e3 * one.run.largest_shift},
                                  {"least_zmp_margin_mm", 1e3 * one.run.least_zmp_margin},
                                  {"largest_lean_deg", one.run.largest_lean * 180.0 / M_PI}});
    if (one.playback.time_s.empty()) continue;
    playbacks.push_back({DeployName(one.as), one.stabilised, &one.playback});
  }
  // The pictures are on one line, so that the text before them can be read.
  std::string text = JsonText(json);
  text.resize(text.rfind("\n}"));
  return text + ",\n  \"playback\": " + FormatPlaybacks(tree, playbacks) + "\n}\n";
}

}  // namespace elastocal
