// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/simulation/motions.hpp"

namespace elastocal {

/// Writes a motion segment after segment, beginning with the lead-in at rest in the posture
/// `start`.
class MotionWriter {
 public:
  MotionWriter(const Eigen::VectorXd& start, const MotionOptions& options)
      : here_(start), options_(options) {
    Rest(options.lead_in_s);
  }

  Motion motion;

  void Rest(double duration_s) { motion.segments.push_back(Quintic(duration_s, here_)); }

  void MoveTo(const Eigen::VectorXd& posture) {
    motion.segments.push_back(Quintic(options_.move_s, posture));
    here_ = posture;
  }

  void Visit(const std::vector<Eigen::VectorXd>& postures) {
    for (const Eigen::VectorXd& posture : postures) {
      MoveTo(posture);
      Rest(options_.rest_s);
    }
  }

  void Sine(int coordinate, double centre, double amplitude) {
    const double duration = (options_.sine_periods + 2.0) / options_.sine_hz;
    motion.segments.push_back(
        {duration, here_, here_, coordinate, centre, amplitude, options_.sine_hz});
  }

  /// Follows samples (MotionSegment::samples), the first of which is the present posture.
  void Follow(const Eigen::VectorXd& time_s, const Eigen::MatrixXd& samples) {
    MotionSegment segment =
        Quintic(time_s[time_s.size() - 1] - time_s[0], samples.bottomRows<1>().transpose());
    segment.sample_s = time_s.array() - time_s[0];
    segment.samples = samples;
    here_ = segment.to;
    motion.segments.push_back(std::move(segment));
  }

  const Eigen::VectorXd& here() const { return here_; }

 private:
  MotionSegment Quintic(double duration_s, const Eigen::VectorXd& to) const {
    return {.duration_s = duration_s, .from = here_, .to = to};
  }

  Eigen::VectorXd here_;
  const MotionOptions& options_;
};

}  // namespace elastocal
