// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/postures_against.hpp"

#include "elastocal/math/statistics.hpp"
#include "elastocal/robot/coordinates.hpp"
#include "elastocal/screening/positions_by_markers.hpp"

namespace elastocal {
namespace {

constexpr double kRests = 0.1;          // rad: range of a joint whose place is compared
constexpr double kRestingSlide = 0.03;  // m
constexpr double kAsFar = 1e-6;         // rad or m

double TypicalOff(Eigen::VectorXd off, bool rests) {
  if (!rests) off.array() -= Median(off);
  return Median(off.cwiseAbs());
}

}  // namespace

std::vector<int> PosturesAgainst(const ErrorModel& model, const LogSuspicion& sign,
                                 const Recording& recording) {
  std::vector<int> against;
  if (sign.kind != LogContradiction::kSign || sign.linkage >= 0) return against;
  const int c = sign.coordinate;
  Recording undone = recording;
  undone.q.col(c) *= -1.0;
  // What markers do not show is as logged, in either case.
  const Eigen::VectorXd off = (PositionsByMarkers(model, recording) - recording.q).col(c);
  const Eigen::VectorXd off_undone = (PositionsByMarkers(model, undone) - undone.q).col(c);
  const bool slides = JointOfCoordinate(model.tree, c).type == JointType::kPrismatic;
  for (int trial = 0; trial < static_cast<int>(recording.trials.size()); ++trial) {
    std::vector<int> postures;
    for (int i = 0; i < recording.posture_count(); ++i) {
      if (recording.trial[i] == trial) postures.push_back(i);
    }
    if (postures.empty()) continue;
    const Eigen::VectorXd logged = recording.q.col(c)(postures);
    const bool rests = logged.maxCoeff() - logged.minCoeff() < (slides ? kRestingSlide : kRests);
    const double left = TypicalOff(off(postures), rests);
    if (TypicalOff(off_undone(postures), rests) > left + kAsFar) {
      against.insert(against.end(), postures.begin(), postures.end());
    }
  }
  return against;
}

}  // namespace elastocal
