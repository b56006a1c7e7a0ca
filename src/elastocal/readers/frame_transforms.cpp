// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/frame_transforms.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kPoseNumbers = 7;

/// Name of a frame without the slash with which names of ROS 1 may begin.
std::string FrameName(const std::string& name) {
  return name.starts_with('/') ? name.substr(1) : name;
}

std::string LastPart(const std::string& name) { return name.substr(name.rfind('/') + 1); }

std::string ListNames(const std::vector<std::string>& names) {
  constexpr std::size_t kMostNamed = 10;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMostNamed); ++i) {
    text += (i > 0 ? ", " : "") + names[i];
  }
  return names.size() > kMostNamed ? text + " ..." : text;
}

std::string NoFrame(const std::string& name, const std::vector<std::string>& names) {
  const std::string nearest = DidYouMean(name, names);
  return "its tf has no frame " + Quote(name) +
         (nearest.empty() ? "; it has " + ListNames(names) : nearest);
}

Eigen::Quaterniond RotationOf(const double* pose) { return {pose[6], pose[3], pose[4], pose[5]}; }

}  // namespace

FrameTransforms::FrameTransforms(const std::string& frame, std::vector<std::string> bodies)
    : frame_(FrameName(frame)), bodies_(std::move(bodies)) {
  for (std::string& body : bodies_) body = FrameName(body);
}

void FrameTransforms::Add(const StampedTransform& transform, bool is_static,
                          const std::string& place) {
  const std::string parent = FrameName(transform.parent), child = FrameName(transform.child);
  std::string& known = is_static ? statics_[child].parent : motions_[child].parent;
  if (known.empty()) known = parent;
  if (known != parent) {
    contested_.insert(child);
    return;
  }
  if (is_static) {
    const Eigen::Quaterniond rotation = RotationOf(transform.pose.data());
    if (!(rotation.norm() > 1e-3) || !std::isfinite(rotation.norm())) {
      throw InputError(place + "the rotation of frame " + Quote(child) + " is none");
    }
    StaticTransform& to = statics_[child];
    to.T_parent_child.setIdentity();
    to.T_parent_child.linear() = rotation.normalized().toRotationMatrix();
    to.T_parent_child.translation() = Eigen::Map<const Eigen::Vector3d>(transform.pose.data());
    return;
  }
  moving_parents_.insert(parent);
  if (!asked() && moving_parents_.size() > 1) return;  // ChooseFrame has to ask
  // Links of a robot, which move on what moves, are no bodies.
  if (motions_.contains(parent) && parent != frame_) return;
  Motion& motion = motions_[child];
  motion.stamps_ns.push_back(transform.stamp_ns);
  motion.received_ns.push_back(transform.received_ns);
  motion.unstamped += transform.stamp_ns == 0 ? 1 : 0;
  motion.poses.insert(motion.poses.end(), transform.pose.begin(), transform.pose.end());
}

FrameTransforms::StaticPlace FrameTransforms::PlaceOf(const std::string& frame) const {
  StaticPlace place;
  place.root = frame;
  for (std::size_t steps = 0; steps <= statics_.size(); ++steps) {
    const auto up = statics_.find(place.root);
    const bool moves = motions_.contains(place.root);
    if (contested_.contains(place.root) || (moves && up != statics_.end())) {
      place.contested = place.root;
    }
    if (up == statics_.end()) return place;
    place.root = up->second.parent;
    place.T_root_frame = up->second.T_parent_child * place.T_root_frame;
    place.itself = false;
  }
  throw InputError("frame " + Quote(frame) + ": static transforms lead back to it");
}

std::vector<std::string> FrameTransforms::Names() const {
  std::set<std::string> names;
  for (const auto& [child, of] : statics_) names.insert({child, of.parent});
  for (const auto& [child, of] : motions_) names.insert({child, of.parent});
  return {names.begin(), names.end()};
}

std::string FrameTransforms::ChooseFrame(std::string& why_none) const {
  const std::vector<std::string> names = Names();
  if (!frame_.empty()) {
    if (std::find(names.begin(), names.end(), frame_) != names.end()) return frame_;
    why_none = NoFrame(frame_, names);
    return "";
  }
  if (moving_parents_.size() == 1) return *moving_parents_.begin();
  why_none = "in its tf, frames move in several others: " +
             ListNames({moving_parents_.begin(), moving_parents_.end()}) +
             "; give the cameras' frame: tf_frame of the trial in experiment.yaml, or the option "
             "--tf-frame";
  return "";
}

std::vector<std::string> FrameTransforms::ChooseBodies(const std::string& frame,
                                                       std::string& why_none) const {
  if (!bodies_.empty()) {
    const std::vector<std::string> names = Names();
    for (const std::string& body : bodies_) {
      if (std::find(names.begin(), names.end(), body) != names.end()) continue;
      why_none = NoFrame(body, names);
      return {};
    }
    return bodies_;
  }
  std::vector<std::string> found;
  for (const auto& [child, motion] : motions_) {
    if (motion.parent == frame && !motion.stamps_ns.empty()) found.push_back(child);
  }
  if (found.empty()) {
    why_none = "in its tf, nothing moves in frame " + Quote(frame) +
               " itself; give bodies (tf_bodies), or another frame";
  }
  return found;
}

BodyTrack FrameTransforms::Track(const std::string& frame, const std::string& body) const {
  const StaticPlace below = PlaceOf(body), cameras = PlaceOf(frame);
  const auto found = motions_.find(below.root);
  if (found == motions_.end()) {
    throw InputError("frame " + Quote(body) + " does not move: only static transforms lead to it");
  }
  const Motion& motion = found->second;
  const StaticPlace above = PlaceOf(motion.parent);
  for (const StaticPlace* place : {&below, &above, &cameras}) {
    if (place->contested.empty()) continue;
    throw InputError("frame " + Quote(place->contested) + " has several parents");
  }
  if (above.root != cameras.root || motion.stamps_ns.empty()) {
    throw InputError("frame " + Quote(body) + " has no pose in frame " + Quote(frame) +
                     ": it moves in frame " + Quote(motion.parent) +
                     (motions_.contains(above.root) ? ", which moves itself"
                                                    : ", which no static transform joins with it"));
  }
  if (motion.unstamped > 1 && motion.unstamped < motion.stamps_ns.size()) {
    throw InputError("frame " + Quote(body) + ": " + std::to_string(motion.unstamped) + " of " +
                     std::to_string(motion.stamps_ns.size()) + " transforms have no stamp");
  }
  BodyTrack track{body, motion.unstamped > 1 ? motion.received_ns : motion.stamps_ns, motion.poses};
  if (below.itself && motion.parent == frame) return track;
  const Transform T_frame_parent = cameras.T_root_frame.inverse() * above.T_root_frame;
  const Eigen::Quaterniond before(T_frame_parent.linear()), after(below.T_root_frame.linear());
  for (auto pose = track.poses.begin(); pose != track.poses.end(); pose += kPoseNumbers) {
    const Eigen::Quaterniond turn = RotationOf(&*pose).normalized();
    Eigen::Map<Eigen::Vector3d> p(&*pose);
    p = T_frame_parent * (p + turn * below.T_root_frame.translation()).eval();
    Eigen::Map<Eigen::Vector4d>(&*pose + 3) = (before * turn * after).coeffs();
  }
  return track;
}

std::vector<BodyTrack> FrameTransforms::Take(const std::string& source, std::string& why_none) {
  std::vector<BodyTrack> tracks;
  try {
    const std::string frame = ChooseFrame(why_none);
    if (frame.empty()) return {};
    std::multiset<std::string> last_parts;
    const std::vector<std::string> bodies = ChooseBodies(frame, why_none);
    for (const std::string& body : bodies) last_parts.insert(LastPart(body));
    for (const std::string& body : bodies) {
      tracks.push_back(Track(frame, body));
      if (last_parts.count(LastPart(body)) == 1) tracks.back().name = LastPart(body);
    }
  } catch (const InputError& error) {
    throw InputError(source + ": tf: " + error.what());
  }
  motions_.clear();
  return tracks;
}

}  // namespace elastocal
