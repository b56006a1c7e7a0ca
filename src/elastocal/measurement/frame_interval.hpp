// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace elastocal {

/// Frames `begin` to `end - 1` of a trial.
struct FrameInterval {
  int begin = 0;
  int end = 0;

  int size() const { return end - begin; }
  bool operator==(const FrameInterval&) const = default;
};

/// The longest runs of frames 0 to `frame_count` - 1 for which `holds(frame)`, in order.
template <typename Predicate>
std::vector<FrameInterval> RunsWhere(int frame_count, const Predicate& holds) {
  std::vector<FrameInterval> runs;
  for (int frame = 0; frame < frame_count; ++frame) {
    if (!holds(frame)) continue;
    if (runs.empty() || runs.back().end != frame) runs.push_back({frame, frame});
    runs.back().end = frame + 1;
  }
  return runs;
}

/// Number of frames in all intervals together.
inline int FrameCount(const std::vector<FrameInterval>& intervals) {
  int count = 0;
  for (const FrameInterval& interval : intervals) count += interval.size();
  return count;
}

}  // namespace elastocal
