// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/trial_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/clock_by_positions.hpp"
#include "elastocal/measurement/clock_mistake.hpp"
#include "elastocal/measurement/column_step.hpp"
#include "elastocal/measurement/log_mistake.hpp"
#include "elastocal/measurement/posture_frames.hpp"
#include "elastocal/measurement/seen_from.hpp"
#include "elastocal/measurement/smoothed_log.hpp"
#include "elastocal/measurement/support_check.hpp"
#include "elastocal/measurement/trial_clock.hpp"

namespace elastocal {
namespace {

// State of one trial during the steps of SampleTrial.
class TrialSampler {
 public:
  TrialSampler(const MarkedRobot& robot, const Trial& trial, const JointLog& log,
               const MeasurementOptions& options, TrialSamples& result)
      : robot_(robot), trial_(trial), log_(log), options_(options), result_(result) {
    summary().trial = trial;
    summary().joints_source = log.source;
  }

  void Run(const std::vector<int>& markers, MarkerTrajectories trajectories) {
    coordinates_ = LoggedCoordinates(robot_.tree, log_);
    for (Eigen::Index c = 0; c < log_.positions.cols(); ++c) {
      const double step = StepOf(log_.positions.col(c));
      if (step > 0.0) summary().steps[coordinates_[c]] = step;
    }
    TakeMarkers(markers, std::move(trajectories));
    if (markers_.empty()) return Refuse("none of its markers is in the marker file");
    CheckTorques();
    Smooth();
    Eigen::MatrixXd speeds = MarkerSpeeds(trajectories_);
    ForgetEdges(trajectories_, smoothed_log_.margin_s, speeds);
    std::vector<Marker> seen;
    for (const int marker : markers_) seen.push_back(robot_.markers[marker]);
    if (const auto moved = FindMovedSupport(robot_.tree, seen, trial_, trajectories_, Travel())) {
      return Refuse(Describe(*moved, robot_));
    }
    const std::string unclear = TellClock(MotionForClock(speeds));
    if (!unclear.empty()) return Refuse(unclear);
    LeaveOutUnlogged(speeds);
    Average(ChooseFrames(speeds));
    if (result_.frames.empty()) Refuse("the robot is never at rest for long enough");
  }

 private:
  // For each joint of the tree, how far it moves.
  Eigen::VectorXd Travel() const {
    Eigen::VectorXd travel =
        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(robot_.tree.joints.size()));
    for (Eigen::Index c = 0; c < log_.positions.cols(); ++c) {
      for (Eigen::Index j = 0; j < travel.size(); ++j) {
        if (robot_.tree.joints[j].coordinate != coordinates_[c]) continue;
        travel[j] = log_.positions.col(c).maxCoeff() - log_.positions.col(c).minCoeff();
      }
    }
    return travel;
  }

  TrialSummary& summary() { return result_.summary; }

  void Refuse(const std::string& reason) { summary().refused = reason; }

  // Keeps the columns of the markers that take part. `markers_` are their numbers in the robot.
  void TakeMarkers(const std::vector<int>& markers, MarkerTrajectories all) {
    summary().markers_source = all.source;
    summary().rate_hz = all.rate_hz;
    summary().frame_count = all.frame_count();
    std::map<std::string, int> column_of;
    for (int column = 0; column < all.marker_count(); ++column)
      column_of[all.names[column]] = column;
    std::vector<int> columns;
    for (const int marker : markers) {
      const std::string& name = robot_.markers[marker].name;
      const auto found = column_of.find(name);
      if (found == column_of.end() || all.positions.col(3 * found->second).array().isNaN().all()) {
        summary().markers_missing.push_back(name);
        continue;
      }
      markers_.push_back(marker);
      summary().markers.push_back(name);
      for (int axis = 0; axis < 3; ++axis) columns.push_back(3 * found->second + axis);
    }
    for (const Marker& marker : robot_.markers) column_of.erase(marker.name);
    for (const auto& [name, column] : column_of) summary().markers_unknown.push_back(name);
    trajectories_.source = std::move(all.source);
    trajectories_.names = summary().markers;
    trajectories_.rate_hz = all.rate_hz;
    trajectories_.positions = all.positions(Eigen::all, columns);
  }

  // Finds the columns of the log whose torques can be used.
  void CheckTorques() {
    torques_used_.assign(log_.names.size(), false);
    for (const int joint : robot_.torque_sensors) {
      const std::string& name = robot_.tree.joints[joint].name;
      const auto column =
          std::find(log_.names.begin(), log_.names.end(), name) - log_.names.begin();
      if (column < log_.torques.cols() && !std::isnan(log_.torques(0, column))) {
        torques_used_[static_cast<std::size_t>(column)] = true;
      } else {
        summary().torques_missing.push_back(name);
      }
    }
    for (const TorqueFinding& finding : CheckTorqueSensors(log_, options_.torques)) {
      if (!torques_used_[finding.column]) continue;
      summary().bad_torque_sensors.push_back({log_.names[finding.column], finding});
      torques_used_[finding.column] = false;
    }
  }

  // The robot's clusters with the markers that take part, as columns of the trajectories.
  std::vector<LabelCluster> TakeClusters() const {
    std::vector<LabelCluster> clusters;
    for (const LabelCluster& cluster : robot_.clusters) {
      LabelCluster taken{cluster.name, {}};
      for (const int marker : cluster.markers) {
        const auto found = std::find(markers_.begin(), markers_.end(), marker);
        if (found != markers_.end())
          taken.markers.push_back(static_cast<int>(found - markers_.begin()));
      }
      if (taken.markers.size() > 1) clusters.push_back(std::move(taken));
    }
    return clusters;
  }

  void Smooth() {
    const double least_rate = 2.0 * options_.smoothing.cutoff_hz;
    if (!(trajectories_.rate_hz > least_rate)) {
      char text[160];
      std::snprintf(text, sizeof(text),
                    ": has %.3g frames a second; more than %.3g were expected, twice the cutoff of "
                    "the filter",
                    trajectories_.rate_hz, least_rate);
      throw InputError(trajectories_.source + text);
    }
    summary().signal = TakeExcerpt(trajectories_);
    summary().labels = CorrectLabels(TakeClusters(), options_.labels, trajectories_);
    summary().smoothing = SmoothTrajectories(options_.smoothing, trajectories_);
    AddFiltered(trajectories_, summary().signal);
    smoothed_log_ = SmoothLog(log_, options_.smoothing);
  }

  // The markers' motion as seen from links.
  struct Motion {
    std::vector<int> links;
    Eigen::MatrixXd speeds;
    std::optional<MarkerTrajectories> relative;  // without: the trajectories themselves
  };

  // The motion relative to the standing links or, if the root is free, to a body with markers.
  Motion MotionForClock(const Eigen::MatrixXd& speeds) const {
    if (trial_.free_root) {
      if (auto seen = SeeFromMarkedBody(robot_, markers_, trajectories_)) {
        Eigen::MatrixXd relative = MarkerSpeeds(seen->trajectories);
        ForgetEdges(seen->trajectories, smoothed_log_.margin_s, relative);
        return {{seen->link}, std::move(relative), std::move(seen->trajectories)};
      }
    }
    return {trial_.support.empty() ? std::vector<int>{0} : trial_.support, speeds, std::nullopt};
  }

  const MarkerTrajectories& PositionsFrom(const Motion& seen) const {
    return seen.relative ? *seen.relative : trajectories_;
  }

  ClockOptions ClockSettings() const {
    ClockOptions options = options_.clock;
    if (!trial_.of_motion()) options.largest_sd_s = options_.largest_rest_lag_sd_s;
    return options;
  }

  /// Estimates the clock. Returns the reason if it cannot be told, else an empty text.
  std::string TellClock(const Motion& seen) {
    std::string untold = TellClockByLog(seen);
    if (options_.accepted.empty()) return untold;
    const SmoothedLog as_logged = smoothed_log_;
    const bool told = untold.empty();
    std::vector<std::string> undone = UndoAccepted(seen);
    untold = TellClockByLog(seen);
    smoothed_log_ = as_logged;  // whether all trials have it, they tell together
    if (!told && untold.empty()) summary().clock_without = std::move(undone);
    return untold;
  }

  /// The mistakes, of those that the user accepted, without which the speeds agree better.
  std::vector<std::string> UndoAccepted(const Motion& seen) {
    std::vector<std::string> undone;
    FitClock(seen);
    double peak = summary().clock.peak;
    for (const LogMistake& mistake : MistakesOf(options_.accepted, log_.names)) {
      SmoothedLog other = WithoutMistake(smoothed_log_, mistake);
      std::swap(other, smoothed_log_);
      FitClock(seen);
      if (summary().clock.peak > peak) {
        peak = summary().clock.peak;
        undone.push_back(NameOf(mistake, log_.names));
      } else {
        std::swap(other, smoothed_log_);
      }
    }
    return undone;
  }

  std::string TellClockByLog(const Motion& seen) {
    ClockFit& clock = summary().clock;
    FitClock(seen);
    if (clock.state == ClockState::kReliable) {
      TellByPositions(seen);
      if (trial_.of_motion()) Refine(seen);  // half a millisecond matters there
      return "";
    }
    const auto mistake =
        FindLogMistake(robot_, markers_, seen.links, smoothed_log_, coordinates_, seen.speeds,
                       PositionsFrom(seen), options_.expected_lag_s, ClockSettings(), clock);
    if (mistake) return Describe(clock) + "; " + Describe(*mistake, log_.names);
    const std::string copies = DescribeCopies(smoothed_log_, log_.names);
    if (!copies.empty()) return Describe(clock) + "; " + copies;
    if (clock.state == ClockState::kAmbiguous && TellByPositions(seen)) return "";
    const std::string cause = CauseOfBadClock(seen);
    if (!cause.empty()) return Describe(clock) + cause;
    const bool vague =
        clock.state == ClockState::kImprecise || clock.state == ClockState::kAmbiguous;
    if (vague) Refine(seen);
    if (RestsBearIt()) clock.state = ClockState::kReliable;
    return clock.state == ClockState::kReliable ? "" : Describe(clock);
  }

  LoggedSpeeds SpeedsOfLog(const Motion& seen) const {
    return PredictSpeeds(robot_, markers_, seen.links, smoothed_log_, coordinates_,
                         trajectories_.rate_hz);
  }

  void FitClock(const Motion& seen) {
    summary().clock = EstimateTrialClock(seen.speeds, trajectories_.rate_hz, SpeedsOfLog(seen),
                                         options_.expected_lag_s, ClockSettings());
  }

  /// Chooses between two lags by positions (LagByPositions). In a motion there and back, the speeds
  /// agree at two lags, perhaps best at the wrong one. Returns whether the positions tell the lag.
  bool TellByPositions(const Motion& seen) {
    constexpr double kAsWell = 0.99, kBothFit = 0.99, kAsLong = 0.85, kNear_s = 0.3;
    ClockFit& clock = summary().clock;
    const bool told = clock.state == ClockState::kReliable;
    if (clock.second_peak < (told ? kAsWell * clock.peak : kBothFit)) return false;
    const auto lag_s = LagByPositions(robot_, markers_, seen.links, smoothed_log_, coordinates_,
                                      PositionsFrom(seen), clock);
    if (!lag_s || (told && *lag_s == clock.lag_s)) return false;
    ClockOptions near = ClockSettings();
    near.longest_lag_s = kNear_s;
    const ClockFit there =
        EstimateTrialClock(seen.speeds, trajectories_.rate_hz, SpeedsOfLog(seen), *lag_s, near);
    const bool long_enough = !told || there.overlap_s >= kAsLong * clock.overlap_s;
    const bool better = there.state == ClockState::kReliable && long_enough;
    if (better) clock = there;
    return better;
  }

  void Refine(const Motion& seen) {
    summary().clock = RefineClock(robot_, markers_, seen.links, smoothed_log_, coordinates_,
                                  PositionsFrom(seen), summary().clock, ClockSettings());
  }

  /// Whether the lag is hardly worse known than asked, and the robot moves from rest to rest. A
  /// joint that was frozen for a while spoils the clock, and is named once the trial is used.
  bool RestsBearIt() const {
    constexpr double kWorse = 5.0 / 3.0;
    return result_.summary.clock.state == ClockState::kImprecise && !trial_.of_motion() &&
           result_.summary.clock.sd_s <= kWorse * options_.largest_rest_lag_sd_s;
  }

  std::string CauseOfBadClock(const Motion& seen) const {
    const auto means = TakeMeanSpeeds(seen.speeds, trajectories_.rate_hz, SpeedsOfLog(seen),
                                      options_.expected_lag_s, ClockSettings());
    if (!means) return "";
    const auto of_clock = FindClockMistake(*means, result_.summary.clock.peak);
    return of_clock ? "; " + Describe(*of_clock) : "";
  }

  double CameraTime(int frame) const { return frame / trajectories_.rate_hz; }
  double RobotTime(int frame) const { return result_.summary.clock.RobotTime(CameraTime(frame)); }

  // Frames without joint positions cannot be used, even if the robot is at rest.
  void LeaveOutUnlogged(Eigen::MatrixXd& speeds) {
    summary().log_begin_s = summary().clock.CameraTime(log_.time_s[0]);
    summary().log_end_s = summary().clock.CameraTime(log_.time_s[log_.time_s.size() - 1]);
    for (int frame = 0; frame < trajectories_.frame_count(); ++frame) {
      if (smoothed_log_.Covers(RobotTime(frame))) continue;
      speeds.row(frame).setConstant(kNaN);
      ++summary().outside_log;
    }
  }

  PostureFrames ChooseFrames(const Eigen::MatrixXd& speeds) {
    std::vector<int> all(markers_.size());
    for (std::size_t m = 0; m < all.size(); ++m) all[m] = static_cast<int>(m);
    summary().rests = FindStableSamples(speeds, all, trajectories_.rate_hz, options_.rest);
    const StableSamples& rests = *summary().rests;
    const TimedTrial timed{trajectories_, smoothed_log_, summary().clock};
    return trial_.of_motion() ? MotionPostures(timed, rests, options_.sine_rate_hz)
                              : RestPostures(timed, rests);
  }

  void Average(const PostureFrames& postures) {
    const auto count = static_cast<Eigen::Index>(postures.size());
    const auto joints = static_cast<Eigen::Index>(robot_.tree.joints.size());
    result_.time_s.resize(count);
    result_.q = robot_.q_not_logged.transpose().replicate(count, 1);
    result_.markers.setConstant(count, 3 * static_cast<Eigen::Index>(robot_.markers.size()), kNaN);
    result_.torques.setConstant(count, joints, kNaN);
    for (const ForceTorqueSensor& sensor : log_.wrench_sensors) {
      result_.wrench_links.push_back(sensor.link);
    }
    result_.wrenches.resize(count, log_.wrenches.cols());
    for (Eigen::Index i = 0; i < count; ++i) {
      const std::vector<int>& frames = postures[static_cast<std::size_t>(i)];
      std::vector<int>& chosen = summary().signal.chosen;
      chosen.insert(chosen.end(), frames.begin(), frames.end());
      result_.frames.push_back(static_cast<int>(frames.size()));
      AverageMarkers(frames, i);
      AverageLog(frames, i);
    }
    CountSamples();
  }

  void AverageMarkers(const std::vector<int>& frames, Eigen::Index posture) {
    for (std::size_t m = 0; m < markers_.size(); ++m) {
      Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
      // A NaN in one frame makes the mean NaN.
      for (const int frame : frames)
        sum += trajectories_.positions.block<1, 3>(frame, 3 * static_cast<Eigen::Index>(m));
      result_.markers.block<1, 3>(posture, 3 * markers_[m]) =
          sum / static_cast<double>(frames.size());
    }
  }

  void AverageLog(const std::vector<int>& frames, Eigen::Index posture) {
    Eigen::VectorXd sum;
    double time = 0.0;
    for (const int frame : frames) {
      const Eigen::VectorXd signals = *smoothed_log_.At(RobotTime(frame));
      sum = sum.size() == 0 ? signals : (sum + signals).eval();
      time += CameraTime(frame);
    }
    const auto count = static_cast<double>(frames.size());
    result_.time_s[posture] = time / count;
    sum /= count;
    const int joints = smoothed_log_.joints;
    for (int c = 0; c < joints; ++c) {
      result_.q(posture, coordinates_[c]) = sum[c];
      if (!torques_used_[static_cast<std::size_t>(c)]) continue;
      result_.torques(posture, robot_.tree.coordinate_joint[coordinates_[c]]) = sum[joints + c];
    }
    result_.wrenches.row(posture) = sum.tail(log_.wrenches.cols()).transpose();
  }

  void CountSamples() {
    summary().postures = static_cast<int>(result_.frames.size());
    for (const int count : result_.frames) summary().samples += count;
    for (const int marker : markers_) {
      const auto missing = result_.markers.col(3 * marker).array().isNaN().count();
      summary().postures_seen.push_back(summary().postures - static_cast<int>(missing));
    }
  }

  const MarkedRobot& robot_;
  const Trial& trial_;
  const JointLog& log_;
  const MeasurementOptions& options_;
  TrialSamples& result_;
  std::vector<int> coordinates_;    // of the log's joints
  std::vector<bool> torques_used_;  // by joint of the log
  std::vector<int> markers_;        // of the robot: the columns of the trajectories
  MarkerTrajectories trajectories_;
  SmoothedLog smoothed_log_;
};

}  // namespace

TrialSamples SampleTrial(const MarkedRobot& robot, const Trial& trial,
                         const std::vector<int>& markers, MarkerTrajectories trajectories,
                         const JointLog& log, const MeasurementOptions& options) {
  TrialSamples result;
  TrialSampler(robot, trial, log, options, result).Run(markers, std::move(trajectories));
  return result;
}

}  // namespace elastocal
