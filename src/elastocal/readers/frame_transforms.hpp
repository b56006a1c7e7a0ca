// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "elastocal/math/transform.hpp"
#include "elastocal/readers/body_track.hpp"

namespace elastocal {

/// One transform of a tf message: the pose of `child` in `parent`.
struct StampedTransform {
  std::string parent, child;
  std::int64_t stamp_ns = 0;  ///< 0 if it was not set
  std::int64_t received_ns = 0;
  std::array<double, 7> pose{};  ///< x y z [m], quaternion x y z w
};

/// The frames of a bag's tf: a forest in which some transforms change and others (`/tf_static`) do
/// not. A body is a frame with exactly one changing transform between it and the cameras' frame.
class FrameTransforms {
 public:
  /// `frame` is the cameras' frame; empty: the frame in which others move. `bodies` are the frames
  /// that are wanted; empty: the moving children of the cameras' frame.
  FrameTransforms(const std::string& frame, std::vector<std::string> bodies);

  bool empty() const { return motions_.empty(); }
  /// Whether the user asked for a frame.
  bool asked() const { return !frame_.empty(); }

  /// Adds a transform; call it in the order of the bag. `place` is the beginning of messages about
  /// it. Throws InputError for a static transform whose quaternion is no rotation.
  void Add(const StampedTransform& transform, bool is_static, const std::string& place);

  /// Poses of the bodies in the cameras' frame. Bodies are named by the last part of their frames'
  /// names if these parts differ. If no static transform lies between, poses are the numbers of the
  /// messages. Empties the object. Returns no tracks, with the reason in `why_none`, for a frame
  /// that does not exist (with the nearest name), or several frames in which others move. Throws
  /// InputError beginning with `source` for bodies without a pose in the frame, and if only some
  /// messages have stamps.
  std::vector<BodyTrack> Take(const std::string& source, std::string& why_none);

 private:
  struct StaticTransform {
    std::string parent;
    Transform T_parent_child = Transform::Identity();
  };
  struct Motion {
    std::string parent;
    std::vector<std::int64_t> stamps_ns, received_ns;
    std::vector<double> poses;
    std::size_t unstamped = 0;
  };
  /// Pose of a frame in the frame at the upper end of its static transforms (`root`).
  struct StaticPlace {
    std::string root;
    Transform T_root_frame = Transform::Identity();
    bool itself = true;          ///< whether the frame is itself the upper end
    std::string contested = {};  ///< a frame on the way that has several parents; empty: none
  };

  StaticPlace PlaceOf(const std::string& frame) const;
  std::vector<std::string> Names() const;
  /// The cameras' frame; empty, and `why_none` says why.
  std::string ChooseFrame(std::string& why_none) const;
  std::vector<std::string> ChooseBodies(const std::string& frame, std::string& why_none) const;
  BodyTrack Track(const std::string& frame, const std::string& body) const;

  std::string frame_;
  std::vector<std::string> bodies_;
  std::map<std::string, StaticTransform> statics_;  ///< by child
  std::map<std::string, Motion> motions_;           ///< by child
  std::set<std::string> moving_parents_;
  std::set<std::string> contested_;  ///< with several parents
};

}  // namespace elastocal
