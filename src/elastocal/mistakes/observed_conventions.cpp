// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/observed_conventions.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include <Eigen/Geometry>

#include "elastocal/math/numbers.hpp"
#include "elastocal/observation/flush_contact.hpp"
#include "elastocal/observation/observation_fault.hpp"
#include "elastocal/observation/seen_tag.hpp"

namespace elastocal {
namespace {

/// Attitude of a pose, whose quaternion is x, y, z, w.
Eigen::Quaterniond AttitudeIn(const Eigen::VectorXd& pose) {
  return Eigen::Quaterniond(Eigen::Vector4d(pose.tail<4>()));
}

Eigen::VectorXd PoseOf(const Eigen::Vector3d& position, const Eigen::Quaterniond& attitude) {
  Eigen::VectorXd pose(7);
  pose << position, attitude.coeffs();
  return pose;
}

Eigen::VectorXd WithWLast(const Eigen::VectorXd& pose) {
  return PoseOf(pose.head<3>(), Eigen::Quaterniond(pose[3], pose[4], pose[5], pose[6]));
}

Eigen::VectorXd WithWFirst(const Eigen::VectorXd& pose) {
  return PoseOf(pose.head<3>(), Eigen::Quaterniond(pose[5], pose[6], pose[3], pose[4]));
}

Eigen::VectorXd WithAttitudeReversed(const Eigen::VectorXd& pose) {
  return PoseOf(pose.head<3>(), AttitudeIn(pose).conjugate());
}

Eigen::VectorXd Inverse(const Eigen::VectorXd& pose) {
  const Eigen::Quaterniond back = AttitudeIn(pose).conjugate();
  return PoseOf(back * Eigen::Vector3d(-pose.head<3>()), back);
}

/// Reverses y of a position, or of a pose.
Eigen::VectorXd Mirrored(const Eigen::VectorXd& measured) {
  Eigen::VectorXd mirrored = measured;
  mirrored[1] *= -1.0;
  if (measured.size() == 7) {
    mirrored[3] *= -1.0;
    mirrored[5] *= -1.0;
  }
  return mirrored;
}

Eigen::VectorXd WithUvExchanged(const Eigen::VectorXd& corners) {
  Eigen::VectorXd exchanged = corners;
  for (int i = 0; i < exchanged.size(); i += 2) std::swap(exchanged[i], exchanged[i + 1]);
  return exchanged;
}

/// Reverses v of the corners; the centre of the camera counts as the middle of the image.
Eigen::VectorXd WithVDownwards(const Instrument& instrument, const Eigen::VectorXd& corners) {
  const auto& tag = dynamic_cast<const SeenTag&>(instrument);
  Eigen::VectorXd downwards = corners;
  for (int i = 1; i < downwards.size(); i += 2) downwards[i] = 2.0 * tag.camera.cy - corners[i];
  return downwards;
}

/// Reorders corners that run clockwise from number `first`.
Eigen::VectorXd Counterclockwise(const Eigen::VectorXd& corners, int first) {
  Eigen::VectorXd turned = corners;
  for (int corner = 0; corner < 4; ++corner) {
    turned.segment<2>(2 * corner) = corners.segment<2>(2 * ((4 + first - corner) % 4));
  }
  return turned;
}

/// Reorders corners that run counterclockwise from number `first`.
Eigen::VectorXd FromBelowLeft(const Eigen::VectorXd& corners, int first) {
  Eigen::VectorXd turned = corners;
  for (int corner = 0; corner < 4; ++corner) {
    turned.segment<2>(2 * corner) = corners.segment<2>(2 * ((4 + corner - first) % 4));
  }
  return turned;
}

/// The robot with tags of `factor` times their size: all, or those for which `holds` is true.
ObservedRobot WithTagsOf(const ObservedRobot& model, double factor, const auto& holds) {
  ObservedRobot robot = model;
  for (auto& instrument : robot.setup.instruments) {
    const auto* tag = dynamic_cast<const SeenTag*>(instrument.get());
    if (tag == nullptr || !holds(*instrument)) continue;
    auto other = std::make_shared<SeenTag>(*tag);
    other->p_tag_corner *= factor;
    instrument = std::move(other);
  }
  return robot;
}

bool IsOf(const Instrument& instrument, const MeasuredBy& of) {
  if (of.quantity < 0) return instrument.name == of.name;
  return std::ranges::find(instrument.quantities, of.quantity) != instrument.quantities.end();
}

class Conventions {
 public:
  /// `of` is the device whose measurements are rewritten; empty: all.
  Conventions(const ObservedRobot& model, const Observations& observations,
              std::optional<MeasuredBy> of)
      : model_(model), observations_(observations), of_(std::move(of)) {}

  bool Holds(const Instrument& instrument) const { return !of_ || IsOf(instrument, *of_); }

  /// Adds that the project has a multiple of the size of all tags.
  void AddSizeOfTags(double factor) {
    WrittenConvention convention{"size_mm of tags is " +
                                     std::to_string(std::lround(std::max(factor, 1.0 / factor))) +
                                     (factor > 1.0 ? " times too large" : " times too small"),
                                 "the edge of the black square in mm", "", observations_};
    convention.robot =
        WithTagsOf(model_, 1.0 / factor, [&](const Instrument& tag) { return Holds(tag); });
    Take(std::move(convention));
  }

  /// Adds a convention that rewrites the measurements of these kinds of instruments, if there are
  /// any.
  void Add(const std::vector<std::string_view>& kinds, const auto& rewrite, const std::string& what,
           const std::string& right, const std::string& family = "") {
    WrittenConvention convention{what, right, family, observations_};
    convention.turns_mountings = kinds.front() == "image" || kinds.front() == "gravity";
    bool any = false;
    for (Observation& observation : convention.undone.all) {
      const Instrument& instrument = model_.instrument(observation.instrument);
      const std::string_view kind = instrument.kind();
      if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) continue;
      if (!Holds(instrument)) continue;
      if constexpr (std::is_invocable_v<decltype(rewrite), Instrument, Eigen::VectorXd>) {
        observation.measured = rewrite(instrument, observation.measured);
      } else {
        observation.measured = rewrite(observation.measured);
      }
      any = true;
    }
    if (any) Take(std::move(convention));
  }

  /// Adds that the project has the plate's face on the other side of the hand.
  void AddSideOfPlates() {
    WrittenConvention convention{"the normal of plates points into the table", "out of the table",
                                 "", observations_};
    ObservedRobot robot = model_;
    for (std::size_t k = 0; k < robot.setup.plates.size(); ++k) {
      const auto* plate = dynamic_cast<const FlushContact*>(robot.setup.instruments[k].get());
      if (plate == nullptr || !Holds(*plate)) continue;
      auto other = std::make_shared<FlushContact>(*plate);
      other->face.R_link_face = (other->face.R_link_face * RotX(M_PI).linear()).eval();
      robot.setup.plates[k].face = other->face;
      robot.setup.instruments[k] = std::move(other);
      convention.robot = robot;
    }
    if (convention.robot) {
      convention.robot = std::move(robot);
      Take(std::move(convention));
    }
  }

  std::vector<WrittenConvention> found;

 private:
  void Take(WrittenConvention convention) {
    if (of_) {
      convention.what += " (" + of_->name + " alone)";
      if (!convention.family.empty()) convention.family += " (" + of_->name + " alone)";
    }
    found.push_back(std::move(convention));
  }

  const ObservedRobot& model_;
  const Observations& observations_;
  std::optional<MeasuredBy> of_;
};

void AddOfBodies(Conventions& conventions) {
  conventions.Add({"pose"}, WithWLast, "w comes first in the quaternions of bodies", "x, y, z, w");
  conventions.Add({"pose"}, WithWFirst,
                  "the columns qw, qx, qy, qz have x, y, z, w of the quaternions of bodies",
                  "each under its name");
  conventions.Add({"pose"}, WithAttitudeReversed,
                  "the attitudes of bodies are those of the tracker in the body",
                  "that of the body in the tracker");
  conventions.Add({"pose"}, Inverse, "the poses of bodies are those of the tracker in the body",
                  "that of the body in the tracker");
  conventions.Add({"pose", "position"}, Mirrored, "one axis of the tracker is reversed",
                  "a right-handed frame");
  for (int axis = 0; axis < 3; ++axis) {
    const auto reversed = [axis](Eigen::VectorXd pose) {
      pose[axis] *= -1.0;
      return pose;
    };
    conventions.Add({"pose"}, reversed,
                    std::string(1, "xyz"[axis]) +
                        " of the positions of bodies is reversed, but not "
                        "in their attitudes",
                    "one right-handed frame of both");
  }
}

void AddOfImages(Conventions& conventions) {
  conventions.Add({"image"}, WithUvExchanged, "u and v of the corners of tags are exchanged",
                  "u to the right and v down");
  conventions.Add({"image"}, WithVDownwards, "v of the corners of tags is counted upwards",
                  "v from the upper edge of the image down");
}

void AddUnitsOfTags(Conventions& conventions) {
  for (const double factor : {10.0, 0.1}) conventions.AddSizeOfTags(factor);
}

void AddOfTags(Conventions& conventions) {
  const char* const places[] = {"below left", "below right", "above right", "above left"};
  for (int first = 0; first < 4; ++first) {
    const auto counterclockwise = [first](const Eigen::VectorXd& corners) {
      return Counterclockwise(corners, first);
    };
    conventions.Add({"image"}, counterclockwise,
                    std::string("the corners of tags run clockwise from ") + places[first],
                    "counterclockwise from below left", "the corners of tags run clockwise");
    if (first == 0) continue;
    const auto from_below_left = [first](const Eigen::VectorXd& corners) {
      return FromBelowLeft(corners, first);
    };
    conventions.Add({"image"}, from_below_left,
                    std::string("the corners of tags are counted from ") + places[first] +
                        ", or tags are turned by " +
                        std::to_string(90 * std::min(first, 4 - first)) + " degrees about their z",
                    "counterclockwise from below left of a tag that stands as rpy_deg says");
  }
}

/// Adds other units than m for lengths that trackers, gauges or wires measured.
void AddUnits(Conventions& conventions, const std::vector<std::string_view>& kinds,
              const std::string& what) {
  const std::pair<const char*, double> units[] = {
      {"mm", 1e-3}, {"cm", 1e-2}, {"inches", 0.0254}, {"feet", 0.3048}};
  for (const auto& [unit, metres] : units) {
    const auto in_metres = [m = metres](Eigen::VectorXd measured) {
      measured.head(std::min<Eigen::Index>(3, measured.size())) *= m;
      return measured;
    };
    conventions.Add(kinds, in_metres, what + " are in " + unit, "m");
  }
}

void AddOfInertialUnits(Conventions& conventions) {
  const std::string right = "9.81 m/s^2 along the axis that points up while the robot is at rest";
  const std::string family =
      "the axes of inertial units are left-handed (all or one of them reversed, or two exchanged)";
  const auto add = [&](const auto& rewrite, const std::string& what) {
    conventions.Add({"gravity"}, rewrite, what, right, family);
  };
  add([](const Eigen::VectorXd& shown) -> Eigen::VectorXd { return -shown; },
      "all axes of inertial units are reversed");
  for (int axis = 0; axis < 3; ++axis) {
    const auto reversed = [axis](Eigen::VectorXd shown) {
      shown[axis] *= -1.0;
      return shown;
    };
    add(reversed, std::string(1, "xyz"[axis]) + " of inertial units is reversed");
    const int next = (axis + 1) % 3;
    const auto exchanged = [axis, next](Eigen::VectorXd shown) {
      std::swap(shown[axis], shown[next]);
      return shown;
    };
    add(exchanged,
        std::string(1, "xyz"[axis]) + " and " + "xyz"[next] + " of inertial units are exchanged");
  }
}

}  // namespace

std::optional<WrittenConvention> CamerasAsBodies(const ObservedRobot& model,
                                                 const Observations& observations) {
  std::set<int> cameras;  // indices of quantities
  for (const Observation& of : observations.all) {
    const Instrument& instrument = model.instrument(of.instrument);
    if (TagSeenBy(instrument) >= 0) cameras.insert(instrument.quantities.front());
  }
  if (cameras.empty()) return std::nullopt;
  Eigen::Matrix3d R_body_camera;
  R_body_camera << 0, 0, 1,  //
      -1, 0, 0,              //
      0, -1, 0;
  ObservedRobot robot = model;
  for (const int camera : cameras) {
    Transform& origin = robot.setup.quantities[Size(camera)].origin;
    origin.linear() = (origin.linear() * R_body_camera).eval();
  }
  return WrittenConvention{.what = "rpy_deg of cameras is that of a body with x ahead and z up",
                           .right = "that of z ahead, x to the right of the image and y down",
                           .family = "",
                           .undone = observations,
                           .turns_mountings = true,
                           .robot = std::move(robot)};
}

std::vector<WrittenConvention> WrittenConventions(const ObservedRobot& model,
                                                  const Observations& observations,
                                                  const std::optional<MeasuredBy>& of) {
  Conventions conventions(model, observations, of);
  const std::string kind = of ? of->kind : "";
  if (kind.empty() || kind == "pose") AddOfBodies(conventions);
  if (kind.empty() || kind == "camera") AddOfImages(conventions);
  const bool tags = std::any_of(observations.all.begin(), observations.all.end(),
                                [&](const Observation& observation) {
                                  return TagSeenBy(model.instrument(observation.instrument)) >= 0;
                                });
  if ((kind.empty() || kind == "tag") && tags) AddOfTags(conventions);
  if (kind.empty() || kind == "gravity") AddOfInertialUnits(conventions);
  if (kind.empty() || kind == "flush contact") conventions.AddSideOfPlates();
  if (kind.empty() || kind == "plane distance") {
    conventions.Add(
        {"plane distance"},
        [](const Eigen::VectorXd& height) -> Eigen::VectorXd { return -height; },
        "heights have the opposite sign", "how far the point is from its plane along the normal");
    AddUnits(conventions, {"plane distance"}, "heights");
  }
  if (kind.empty() || kind == "wire") AddUnits(conventions, {"wire"}, "lengths of wires");
  if (kind.empty() || kind == "pose" || kind == "position") {
    AddUnits(conventions, {"pose", "position"}, "positions that trackers measured");
  }
  return std::move(conventions.found);
}

std::vector<WrittenConvention> TagsInOtherUnits(const ObservedRobot& model,
                                                const Observations& observations) {
  Conventions conventions(model, observations, std::nullopt);
  AddUnitsOfTags(conventions);
  return std::move(conventions.found);
}

bool IsMeasuredBy(const ObservedRobot& model, const Observation& observation,
                  const MeasuredBy& of) {
  return IsOf(model.instrument(observation.instrument), of);
}

std::vector<MeasuredBy> SeveralAlike(const ObservedRobot& model, const Observations& observations) {
  std::vector<MeasuredBy> all;
  const auto add = [&](const std::string& kind, const std::string& name, int quantity) {
    const bool known = std::any_of(all.begin(), all.end(), [&](const MeasuredBy& of) {
      return of.kind == kind && of.name == name;
    });
    if (!known) all.push_back({kind, name, quantity});
  };
  for (const Observation& of : observations.all) {
    const Instrument& instrument = model.instrument(of.instrument);
    if (TagSeenBy(instrument) < 0) {
      add(instrument.kind(), instrument.name, -1);
      continue;
    }
    const std::size_t between = instrument.name.find('/');
    add("camera", instrument.name.substr(0, between), instrument.quantities.front());
    add("tag", instrument.name.substr(between + 1), TagSeenBy(instrument));
  }
  std::vector<MeasuredBy> several;
  for (const MeasuredBy& of : all) {
    const auto alike = std::count_if(
        all.begin(), all.end(), [&](const MeasuredBy& other) { return other.kind == of.kind; });
    if (alike > 1) several.push_back(of);
  }
  return several;
}

}  // namespace elastocal
