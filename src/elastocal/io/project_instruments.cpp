#include <algorithm>
#include <set>
#include <string>

#include <Eigen/Eigenvalues>

#include "elastocal/io/project_sections.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kMostInstruments = 1000;

std::vector<YamlValue> ListOf(const YamlValue& section, const char* key) {
  const auto list = section.Find(key);
  if (!list) return {};
  std::vector<YamlValue> items = list->Items();
  list->Expect(items.size() <= kMostInstruments, "at most 1000 of them");
  return items;
}

/// Numbers of a list, each within its bounds.
Eigen::VectorXd NumbersOf(const YamlValue& list, std::size_t size) {
  const std::vector<YamlValue> items = list.Items();
  list.Expect(items.size() == size, std::to_string(size) + " numbers");
  Eigen::VectorXd numbers(static_cast<Eigen::Index>(size));
  for (std::size_t i = 0; i < size; ++i) {
    numbers[static_cast<Eigen::Index>(i)] = items[i].Bounded();
  }
  return numbers;
}

Eigen::Vector3d PointOf(const YamlValue& value, const char* key) {
  const auto point = value.Find(key);
  return point ? PointFromMm(*point) : Eigen::Vector3d::Zero();
}

Eigen::Matrix3d AxesOf(const YamlValue& value) {
  const auto rpy = value.Find("rpy_deg");
  if (!rpy) return Eigen::Matrix3d::Identity();
  return FromXyzRpy(Eigen::Vector3d::Zero(), kOneDegree * NumbersOf(*rpy, 3)).linear();
}

/// The name of a new instrument, which names columns.
std::string InstrumentName(const YamlValue& value, const Project& project) {
  const YamlValue name = value.Get("name");
  for (const auto& other : project.contact->setup.instruments) {
    if (other->name == name.Text()) {
      name.Fail("a second instrument of the name " + Quote(other->name));
    }
  }
  return name.Text();
}

/// The columns of the instrument added last: those of the key `columns`, or its name with suffixes.
void TakeColumns(const YamlValue& value, const std::vector<std::string>& suffixes,
                 Project& project) {
  std::vector<std::string> columns;
  for (const std::string& suffix : suffixes) columns.push_back(value.Get("name").Text() + suffix);
  if (const auto given = value.Find("columns")) {
    const std::vector<YamlValue> items = given->Items();
    given->Expect(items.size() == suffixes.size(),
                  std::to_string(suffixes.size()) + " columns, as by default [" + columns.front() +
                      (columns.size() > 1 ? ", ..., " + columns.back() : "") + "]");
    for (std::size_t i = 0; i < items.size(); ++i) columns[i] = items[i].Text();
  }
  project.contact->columns.push_back(std::move(columns));
}

template <typename Named>
int NamedBy(const YamlValue& value, const char* what,
            const std::vector<std::pair<std::string, Named>>& known) {
  std::vector<std::string> names;
  for (const auto& [name, of] : known) names.push_back(name);
  const auto found = std::find(names.begin(), names.end(), value.Text());
  if (found == names.end()) {
    value.Fail(std::string("there is no ") + what + " " + Quote(value.Text()) +
               DidYouMean(value.Text().substr(0, 60), names));
  }
  return static_cast<int>(found - names.begin());
}

using NamedTrackers = std::vector<std::pair<std::string, Tracker>>;
using NamedPlanes = std::vector<std::pair<std::string, int>>;

void ReadTracker(const YamlValue& value, Project& project, NamedTrackers& trackers) {
  value.ExpectKeys({"name", "carrier"});
  const std::string name = value.Get("name").Text();
  for (const auto& [other, of] : trackers) {
    if (other == name) value.Get("name").Fail("a second tracker of the name " + Quote(name));
  }
  const auto carrier = value.Find("carrier");
  const int link = carrier ? LinkNamedBy(*carrier, project.tree) : -1;
  trackers.emplace_back(name, AddTracker(project.contact->setup, name, link));
}

Eigen::MatrixXd CovarianceOf(const YamlValue& list) {
  const std::vector<YamlValue> rows = list.Items();
  list.Expect(rows.size() == 6, "six rows of six numbers");
  Eigen::MatrixXd covariance(6, 6);
  for (int i = 0; i < 6; ++i) covariance.row(i) = NumbersOf(rows[i], 6).transpose();
  const double largest = covariance.cwiseAbs().maxCoeff();
  list.Expect((covariance - covariance.transpose()).cwiseAbs().maxCoeff() <= 1e-9 * largest,
              "a symmetric matrix");
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
  list.Expect(eigen.eigenvalues()[0] > 0.0, "a positive definite matrix");
  return covariance;
}

void ReadPose(const YamlValue& value, const NamedTrackers& trackers, Project& project) {
  value.ExpectKeys({"name", "link", "tracker", "xyz_mm", "rpy_deg", "mounting_sd_mm",
                    "mounting_sd_deg", "covariance", "columns"});
  TrackedBodySetup body;
  body.name = InstrumentName(value, project);
  body.link = LinkNamedBy(value.Get("link"), project.tree);
  body.tracker = trackers[NamedBy(value.Get("tracker"), "tracker", trackers)].second;
  body.T_link.linear() = AxesOf(value);
  body.T_link.translation() = PointOf(value, "xyz_mm");
  value.ReadBounded("mounting_sd_mm", body.mounting_sd_m, kOneMm);
  value.ReadBounded("mounting_sd_deg", body.mounting_sd_rad, kOneDegree);
  if (const auto covariance = value.Find("covariance")) body.covariance = CovarianceOf(*covariance);
  AddTrackedBody(project.contact->setup, body);
  TakeColumns(value, {"_x", "_y", "_z", "_qx", "_qy", "_qz", "_qw"}, project);
}

void ReadPosition(const YamlValue& value, const NamedTrackers& trackers, Project& project) {
  value.ExpectKeys({"name", "link", "tracker", "point_mm", "mounting_sd_mm", "columns"});
  TrackedPointSetup point;
  point.name = InstrumentName(value, project);
  point.link = LinkNamedBy(value.Get("link"), project.tree);
  point.tracker = trackers[NamedBy(value.Get("tracker"), "tracker", trackers)].second;
  point.p_link = PointOf(value, "point_mm");
  value.ReadBounded("mounting_sd_mm", point.mounting_sd, kOneMm);
  AddTrackedPoint(project.contact->setup, point);
  TakeColumns(value, {"_x", "_y", "_z"}, project);
}

void ReadInertialUnit(const YamlValue& value, Project& project) {
  value.ExpectKeys({"name", "link", "rpy_deg", "mounting_sd_deg", "bias_sd_m_per_s2", "columns"});
  InertialUnitSetup unit;
  unit.name = InstrumentName(value, project);
  unit.link = LinkNamedBy(value.Get("link"), project.tree);
  unit.R_link_unit = AxesOf(value);
  value.ReadBounded("mounting_sd_deg", unit.mounting_sd, kOneDegree);
  value.ReadBounded("bias_sd_m_per_s2", unit.bias_sd);
  AddInertialUnit(project.contact->setup, unit);
  TakeColumns(value, {"_ax", "_ay", "_az"}, project);
}

void ReadPlane(const YamlValue& value, Project& project, NamedPlanes& planes) {
  value.ExpectKeys({"name", "normal"});
  const std::string name = value.Get("name").Text();
  for (const auto& [other, of] : planes) {
    if (other == name) value.Get("name").Fail("a second plane of the name " + Quote(name));
  }
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  if (const auto given = value.Find("normal")) {
    normal = NumbersOf(*given, 3);
    given->Expect(normal.norm() > 0.0, "a direction");
  }
  planes.emplace_back(name, AddPlane(project.contact->setup, name, normal));
}

void ReadDistance(const YamlValue& value, const NamedPlanes& planes, Project& project) {
  value.ExpectKeys({"name", "link", "plane", "point_mm", "mounting_sd_mm", "columns"});
  PlaneDistanceSetup distance;
  distance.name = InstrumentName(value, project);
  distance.link = LinkNamedBy(value.Get("link"), project.tree);
  distance.plane = planes[NamedBy(value.Get("plane"), "plane", planes)].second;
  distance.p_link = PointOf(value, "point_mm");
  value.ReadBounded("mounting_sd_mm", distance.mounting_sd, kOneMm);
  AddPlaneDistance(project.contact->setup, distance);
  TakeColumns(value, {""}, project);
}

void ReadWire(const YamlValue& value, Project& project) {
  value.ExpectKeys({"name", "link", "point_mm", "anchor_mm", "anchor_sd_mm", "zero_sd_mm",
                    "mounting_sd_mm", "columns"});
  WireSetup wire;
  wire.name = InstrumentName(value, project);
  wire.link = LinkNamedBy(value.Get("link"), project.tree);
  wire.p_link = PointOf(value, "point_mm");
  wire.p_floor = PointFromMm(value.Get("anchor_mm"));
  value.ReadBounded("anchor_sd_mm", wire.anchor_sd, kOneMm);
  value.ReadBounded("zero_sd_mm", wire.zero_sd, kOneMm);
  value.ReadBounded("mounting_sd_mm", wire.mounting_sd, kOneMm);
  AddWire(project.contact->setup, wire);
  TakeColumns(value, {""}, project);
}

Transform PoseOf(const YamlValue& value) {
  Transform pose = Transform::Identity();
  pose.linear() = AxesOf(value);
  pose.translation() = PointOf(value, "xyz_mm");
  return pose;
}

int OptionalLink(const YamlValue& value, const RobotTree& tree) {
  const auto link = value.Find("link");
  return link ? LinkNamedBy(*link, tree) : -1;
}

MountedCamera ReadCamera(const YamlValue& value, Project& project) {
  value.ExpectKeys({"name", "link", "xyz_mm", "rpy_deg", "mounting_sd_mm", "mounting_sd_deg",
                    "focal_px", "centre_px", "distortion", "focal_sd_share"});
  CameraSetup camera;
  camera.name = value.Get("name").Text();
  camera.link = OptionalLink(value, project.tree);
  camera.T_parent = PoseOf(value);
  value.ReadBounded("mounting_sd_mm", camera.mounting_sd_m, kOneMm);
  value.ReadBounded("mounting_sd_deg", camera.mounting_sd_rad, kOneDegree);
  value.ReadBounded("focal_sd_share", camera.focal_sd);
  const Eigen::VectorXd focal = NumbersOf(value.Get("focal_px"), 2);
  const Eigen::VectorXd centre = NumbersOf(value.Get("centre_px"), 2);
  Camera& numbers = camera.camera;
  numbers.fx = focal[0];
  numbers.fy = focal[1];
  numbers.cx = centre[0];
  numbers.cy = centre[1];
  if (const auto distortion = value.Find("distortion")) {
    const Eigen::VectorXd of = NumbersOf(*distortion, 5);
    numbers.k1 = of[0];
    numbers.k2 = of[1];
    numbers.p1 = of[2];
    numbers.p2 = of[3];
    numbers.k3 = of[4];
  }
  return AddCamera(project.contact->setup, camera);
}

MountedTag ReadTag(const YamlValue& value, Project& project) {
  value.ExpectKeys(
      {"name", "link", "xyz_mm", "rpy_deg", "size_mm", "mounting_sd_mm", "mounting_sd_deg"});
  TagSetup tag;
  tag.name = value.Get("name").Text();
  tag.link = OptionalLink(value, project.tree);
  tag.T_parent = PoseOf(value);
  tag.size = kOneMm * value.Get("size_mm").Bounded();
  value.ReadBounded("mounting_sd_mm", tag.mounting_sd_m, kOneMm);
  value.ReadBounded("mounting_sd_deg", tag.mounting_sd_rad, kOneDegree);
  return AddTag(project.contact->setup, tag);
}

/// Quantities and sources are told apart by their names, in the files of a calibration too.
void CheckNames(const YamlValue& section, const ObservationSetup& setup) {
  const auto check = [&](const auto& items) {
    std::set<std::string> names;
    for (const auto& item : items) {
      if (names.insert(item.name).second) continue;
      section.Fail("two things have a quantity or a noise of the name " + Quote(item.name) +
                   "; name one of them otherwise");
    }
  };
  check(setup.quantities);
  check(setup.sources);
}

/// Cameras, tags, and every camera's view of every tag that can move against it.
void ReadCameras(const YamlValue& section, Project& project) {
  std::vector<MountedCamera> cameras;
  std::vector<MountedTag> tags;
  const auto check = [](const YamlValue& value, const char* what, const auto& known) {
    for (const auto& other : known) {
      if (other.of.name != value.Get("name").Text()) continue;
      value.Get("name").Fail(std::string("a second ") + what + " of the name " +
                             Quote(other.of.name));
    }
  };
  for (const YamlValue& value : ListOf(section, "cameras")) {
    check(value, "camera", cameras);
    cameras.push_back(ReadCamera(value, project));
  }
  for (const YamlValue& value : ListOf(section, "tags")) {
    check(value, "tag", tags);
    check(value, "thing", cameras);
    tags.push_back(ReadTag(value, project));
  }
  section.Expect(cameras.empty() == tags.empty(), "both cameras and tags, or neither");
  section.Expect(cameras.size() * tags.size() <= kMostInstruments, "at most 1000 views of tags");
  for (const MountedCamera& camera : cameras) {
    for (const MountedTag& tag : tags) {
      ContactProject& contact = *project.contact;
      contact.seen_tags.push_back(
          {camera.of.name, tag.of.name, static_cast<int>(contact.setup.instruments.size())});
      AddSeenTag(contact.setup, camera, tag);
      contact.columns.emplace_back();
    }
  }
}

}  // namespace

void ReadInstruments(const YamlValue& section, Project& project) {
  section.ExpectKeys({"trackers", "poses", "positions", "inertial_units", "planes", "distances",
                      "wires", "cameras", "tags"});
  if (!project.contact) project.contact.emplace();
  NamedTrackers trackers;
  NamedPlanes planes;
  for (const YamlValue& value : ListOf(section, "trackers")) ReadTracker(value, project, trackers);
  for (const YamlValue& value : ListOf(section, "planes")) ReadPlane(value, project, planes);
  for (const YamlValue& value : ListOf(section, "poses")) ReadPose(value, trackers, project);
  for (const YamlValue& value : ListOf(section, "positions")) {
    ReadPosition(value, trackers, project);
  }
  for (const YamlValue& value : ListOf(section, "inertial_units")) {
    ReadInertialUnit(value, project);
  }
  for (const YamlValue& value : ListOf(section, "distances")) ReadDistance(value, planes, project);
  for (const YamlValue& value : ListOf(section, "wires")) ReadWire(value, project);
  ReadCameras(section, project);
  CheckNames(section, project.contact->setup);
  section.Expect(project.contact->setup.instruments.size() > project.contact->setup.plates.size(),
                 "at least one instrument: poses, positions, inertial_units, distances, wires, or "
                 "cameras and tags");
}

void ObserveMarkers(Project& project) {
  ObservationSetup& setup = project.contact->setup;
  const Tracker cameras = AddTracker(setup, "markers");
  const int noise =
      AddSource(setup, {"markers.noise", SourceUnit::kMetre, 1e-3, Source::Role::kNoise});
  for (const Marker& marker : project.markers) {
    for (const auto& other : setup.instruments) {
      if (other->name != marker.name) continue;
      throw InputError(project.file.string() + ": marker " + Quote(marker.name) +
                       " has the name of an instrument");
    }
    AddTrackedPoint(setup, {.name = marker.name,
                            .link = marker.link,
                            .p_link = marker.p_link_marker,
                            .tracker = cameras,
                            .noise = noise});
    const auto renamed = project.recording.markers.find(marker.name);
    if (renamed != project.recording.markers.end()) {
      project.contact->columns.emplace_back(renamed->second.begin(), renamed->second.end());
    } else {
      project.contact->columns.push_back(
          {marker.name + "_x", marker.name + "_y", marker.name + "_z"});
    }
  }
}

}  // namespace elastocal
