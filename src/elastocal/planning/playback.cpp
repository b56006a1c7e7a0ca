// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/playback.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <stdexcept>

#include <nlohmann/json.hpp>
#include <zlib.h>

#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/report/encoding.hpp"
#include "elastocal/tables/json_text.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;
using Displacement = Eigen::Matrix<double, 6, Eigen::Dynamic>;

constexpr double kUnit = 1e-4;  // m or rad

std::size_t At(int index) { return static_cast<std::size_t>(index); }

/// Links that a joint moves, the root link, and ends of limbs that are neither.
std::vector<int> PlayedLinks(const RobotTree& tree, const std::vector<PlaybackTip>& tips) {
  std::vector<int> links = {0};
  for (const Joint& joint : tree.joints) links.push_back(joint.child_link);
  for (const PlaybackTip& tip : tips) {
    if (std::count(links.begin(), links.end(), tip.link) == 0) links.push_back(tip.link);
  }
  return links;
}

/// Bytes compressed in zlib's format (RFC 1950).
std::string Deflated(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string result(size, '\0');
  const int status =
      compress2(reinterpret_cast<Bytef*>(result.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), Z_BEST_COMPRESSION);
  if (status != Z_OK) throw std::runtime_error("zlib: no memory for " + std::to_string(size));
  result.resize(size);
  return result;
}

/// Encodes numbers in kUnit: each as its difference from that in the picture before (in the first:
/// from zero) in one byte or, if that is too small, as -128 and the number itself in four bytes,
/// little-endian. All of it deflated and in base64.
template <typename Picture>
std::string Base64Differences(const std::vector<Picture>& pictures) {
  constexpr int kMostStep = 127;
  constexpr double kMostNumber = 2e9;
  std::string bytes;
  Eigen::ArrayXXi before;
  for (const Picture& picture : pictures) {
    const Eigen::ArrayXXi now =
        (picture.array() / kUnit).round().min(kMostNumber).max(-kMostNumber).template cast<int>();
    if (before.size() == 0) before = Eigen::ArrayXXi::Zero(now.rows(), now.cols());
    for (Eigen::Index i = 0; i < now.size(); ++i) {
      const std::int64_t number = now.data()[i], step = number - before.data()[i];
      if (std::abs(step) <= kMostStep) {
        bytes += static_cast<char>(step);
        continue;
      }
      bytes += static_cast<char>(-128);
      for (int shift = 0; shift < 32; shift += 8) {
        bytes += static_cast<char>((number >> shift) & 0xff);
      }
    }
    before = now;
  }
  return Base64(Deflated(bytes));
}

/// By picture: x, y, z and quaternion x, y, z, w.
std::vector<double> PoseNumbers(const std::vector<Transform>& poses) {
  std::vector<double> numbers;
  for (const Transform& pose : poses) {
    const Eigen::Vector3d p = pose.translation();
    const Eigen::Quaterniond turn(pose.linear());
    numbers.insert(numbers.end(), {p.x(), p.y(), p.z(), turn.x(), turn.y(), turn.z(), turn.w()});
  }
  return numbers;
}

Json TipJson(const RobotTree& tree, const PlaybackTip& tip) {
  Json distances = Json::array();
  for (double distance : tip.distance_m) {
    // NaN becomes null.
    distances.push_back(std::isfinite(distance) ? Json(std::round(distance / kUnit) / 10.0)
                                                : Json(nullptr));
  }
  return {{"link", tree.links[At(tip.link)].name},
          {"place", tip.is_foot ? "foot" : "hand"},
          {"distance_mm", std::move(distances)}};
}

Json RobotJson(const RobotTree& tree, const NamedPlayback& robot) {
  Json json = {{"as", robot.as},
               {"stabilised", robot.stabilised},
               {"pictures", robot.playback->time_s.size()},
               {"displacement", Base64Differences(robot.playback->displacement)},
               {"tips", Json::array()}};
  for (const PlaybackTip& tip : robot.playback->tips) json["tips"].push_back(TipJson(tree, tip));
  return json;
}

}  // namespace

PlaybackRecorder::PlaybackRecorder(const RobotTree& tree, std::vector<PlaybackTip> tips)
    : tree_(tree) {
  playback_.links = PlayedLinks(tree, tips);
  playback_.tips = std::move(tips);
}

/// Feet do not move in the plan while they stand, so that the root link follows from the standing
/// foot.
Transform PlaybackRecorder::PlanRoot(const std::vector<Transform>& T_root_link, int foot,
                                     const std::vector<Transform>& T_world_link) {
  if (foot_ < 0) {
    T_plan_foot_ = LinkTransforms(
        tree_, Eigen::VectorXd(Eigen::VectorXd::Zero(tree_.coordinate_count())))[At(foot)];
    T_plan_foot_.translation().z() = 0.0;
    T_plan_world_ = T_plan_foot_ * T_world_link[At(foot)].inverse();
  } else if (foot != foot_) {
    const Transform T_plan_root = T_plan_foot_ * T_root_link[At(foot_)].inverse();
    T_plan_foot_ = T_plan_root * T_root_link[At(foot)];
  }
  foot_ = foot;
  return T_plan_foot_ * T_root_link[At(foot)].inverse();
}

void PlaybackRecorder::AddDistances(const std::vector<Transform>& T_root_link,
                                    const std::vector<int>& support,
                                    const std::vector<Transform>& T_world_link) {
  const Transform T_wanted = T_root_link[At(support.front())].inverse();
  const Transform T_got = T_world_link[At(support.front())].inverse();
  for (PlaybackTip& tip : playback_.tips) {
    const bool stands = std::count(support.begin(), support.end(), tip.link) > 0;
    const Eigen::Vector3d wanted = T_wanted * T_root_link[At(tip.link)].translation();
    const Eigen::Vector3d got = T_got * T_world_link[At(tip.link)].translation();
    tip.distance_m.push_back(stands ? std::numeric_limits<double>::quiet_NaN()
                                    : (got - wanted).norm());
  }
}

void PlaybackRecorder::Add(double time_s, const Eigen::VectorXd& q,
                           const std::vector<Transform>& T_root_link,
                           const std::vector<int>& support,
                           const std::vector<Transform>& T_world_link) {
  const Transform T_plan_root = PlanRoot(T_root_link, support.front(), T_world_link);
  Displacement displacement(6, static_cast<Eigen::Index>(playback_.links.size()));
  for (std::size_t i = 0; i < playback_.links.size(); ++i) {
    const Transform wanted = T_plan_root * T_root_link[At(playback_.links[i])];
    const Transform got = T_plan_world_ * T_world_link[At(playback_.links[i])];
    displacement.col(static_cast<Eigen::Index>(i)) << got.translation() - wanted.translation(),
        RotationVector(got.linear() * wanted.linear().transpose());
  }
  playback_.time_s.push_back(time_s);
  playback_.q.push_back(q);
  playback_.T_plan_root.push_back(T_plan_root);
  playback_.displacement.push_back(std::move(displacement));
  AddDistances(T_root_link, support, T_world_link);
}

std::string FormatPlaybacks(const RobotTree& tree, const std::vector<NamedPlayback>& robots) {
  Json json = Json::object();
  if (robots.empty()) return json.dump();
  // The plan is the same for all; the robot that stood longest has most of it.
  const Playback& longest =
      *std::max_element(robots.begin(), robots.end(),
                        [](const NamedPlayback& a, const NamedPlayback& b) {
                          return a.playback->time_s.size() < b.playback->time_s.size();
                        })
           ->playback;
  json["time_s"] = Json::array();
  for (double time : longest.time_s) json["time_s"].push_back(std::round(1e3 * time) / 1e3);
  for (int joint : tree.coordinate_joint) json["joints"].push_back(tree.joints[At(joint)].name);
  json["q"] = Base64Differences(longest.q);
  json["root"] = Base64Floats(PoseNumbers(longest.T_plan_root));
  for (int link : longest.links) json["links"].push_back(tree.links[At(link)].name);
  json["unit_m"] = kUnit;
  json["unit_rad"] = kUnit;
  for (const NamedPlayback& robot : robots) json["robots"].push_back(RobotJson(tree, robot));
  return JsonLine(json);
}

}  // namespace elastocal
