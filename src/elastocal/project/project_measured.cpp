// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>

#include "elastocal/math/numbers.hpp"
#include "elastocal/project/project_sections.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kSmallestCluster = 3;
constexpr double kSmallestExtent = 1e-3;  // m: no markers are that small; one metre, read as mm

void AddMarker(const YamlValue& where, const std::string& name, int link,
               const Eigen::Vector3d& position, Project& project) {
  for (const Marker& marker : project.markers) {
    if (marker.name == name) where.Fail("a second marker of the name " + Quote(name));
  }
  constexpr std::size_t kMostMarkers = 1000;
  if (project.markers.size() >= kMostMarkers) where.Fail("more than 1000 markers");
  project.markers.push_back({name, link, position});
}

/// Positions in metres, read as millimetres, are within a marker's own size of each other.
void CheckUnit(const YamlValue& list, const MarkerCluster& cluster, const Project& project) {
  double extent = 0.0;
  for (const int one : cluster.markers) {
    for (const int other : cluster.markers) {
      extent = std::max(extent, (project.markers[Size(one)].p_link_marker -
                                 project.markers[Size(other)].p_link_marker)
                                    .norm());
    }
  }
  if (extent >= kSmallestExtent) return;
  char text[200];
  std::snprintf(text, sizeof text,
                "the markers are within %.3g mm of each other, which is less than the size of a "
                "marker; are these metres? Positions in mm were expected",
                1e3 * extent);
  list.Fail(text);
}

void ReadCluster(const YamlValue& value, Project& project) {
  value.ExpectKeys({"name", "link", "positions_mm"});
  MarkerCluster cluster;
  cluster.name = NewName(value.Get("name"), "cluster", project.clusters);
  cluster.link = LinkNamedBy(value.Get("link"), project.tree);
  const YamlValue list = value.Get("positions_mm");
  const std::vector<YamlValue> positions = list.Items();
  list.Expect(positions.size() >= kSmallestCluster,
              "at least three positions; fewer markers go to markers.single");
  for (std::size_t i = 0; i < positions.size(); ++i) {
    cluster.markers.push_back(static_cast<int>(project.markers.size()));
    AddMarker(positions[i], cluster.name + "_" + std::to_string(i + 1), cluster.link,
              PointFromMm(positions[i]), project);
  }
  CheckUnit(list, cluster, project);
  project.clusters.push_back(std::move(cluster));
}

void ReadSingle(const YamlValue& value, Project& project) {
  value.ExpectKeys({"name", "link", "position_mm"});
  const YamlValue name = value.Get("name");
  AddMarker(name, name.Text(), LinkNamedBy(value.Get("link"), project.tree),
            PointFromMm(value.Get("position_mm")), project);
}

void ReadReference(const YamlValue& value, Project& project) {
  project.reference_cluster = value.Text();
  std::vector<std::string> names;
  for (const MarkerCluster& cluster : project.clusters) {
    names.push_back(cluster.name);
    if (cluster.name != project.reference_cluster) continue;
    if (project.tree.links[cluster.link].body != 0) {
      value.Fail("cluster " + Quote(cluster.name) + " is on link " +
                 Quote(project.tree.links[cluster.link].name) +
                 ", which joints move; the reference is fixed to the root link " +
                 Quote(project.tree.links[0].name));
    }
    return;
  }
  value.Fail("there is no cluster " + Quote(project.reference_cluster) +
             DidYouMean(project.reference_cluster, names));
}

void ReadMarkerColumns(const YamlValue& section, Project& project) {
  std::vector<std::string> names;
  for (const Marker& marker : project.markers) names.push_back(marker.name);
  for (const auto& [name, value] : section.Entries()) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      value.Fail("there is no marker " + Quote(name) + DidYouMean(name.substr(0, 60), names));
    }
    const std::vector<YamlValue> columns = value.Items();
    value.Expect(columns.size() == 3, "the three columns [x, y, z]");
    project.recording.markers[name] = {columns[0].Text(), columns[1].Text(), columns[2].Text()};
  }
}

void ReadLabels(const YamlValue& section, Project& project) {
  std::vector<std::string> names;
  for (const Marker& marker : project.markers) names.push_back(marker.name);
  std::map<std::string, std::string> marker_of;
  for (const auto& [name, value] : section.Entries()) {
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      value.Fail("there is no marker " + Quote(name) + DidYouMean(name.substr(0, 60), names));
    }
    const auto [other, is_new] = marker_of.emplace(value.Text(), name);
    if (!is_new) value.Fail("the label is that of marker " + Quote(other->second) + " already");
    project.recording.labels[name] = value.Text();
  }
}

void ReadColumns(const YamlValue& section, Project& project) {
  section.ExpectKeys({"time", "markers", "joints"});
  if (const auto time = section.Find("time")) project.recording.time = time->Text();
  if (const auto markers = section.Find("markers")) ReadMarkerColumns(*markers, project);
  const auto joints = section.Find("joints");
  if (!joints) return;
  for (const auto& [name, value] : joints->Entries()) {
    DriverNamedBy(name, value, project.tree);
    project.recording.joints[name] = value.Text();
  }
}

/// Reads the positions of joints of one type that are not recorded; `unit` is the file's unit in
/// rad or m.
void ReadNotRecorded(const YamlValue& section, JointType type, double unit, Project& project) {
  for (const auto& [name, value] : section.Entries()) {
    const int joint = DriverNamedBy(name, value, project.tree);
    if (project.tree.joints[joint].type != type) {
      value.Fail(type == JointType::kRevolute
                     ? "the joint is prismatic: give it in not_recorded_mm"
                     : "the joint is revolute: give it in not_recorded_deg");
    }
    project.recording.not_recorded[name] = unit * value.Bounded();
  }
}

void ReadReferenceLengths(const YamlValue& section, Project& project) {
  for (const YamlValue& value : section.Items()) {
    value.ExpectKeys({"markers", "length_mm", "sd_mm"});
    ReferenceLength reference;
    const std::vector<YamlValue> markers = value.Get("markers").Items();
    value.Get("markers").Expect(markers.size() == 2, "the labels of two markers");
    for (std::size_t end = 0; end < 2; ++end) {
      reference.markers[end] = markers[end].Text();
      for (const Marker& marker : project.markers) {
        if (marker.name == reference.markers[end]) {
          markers[end].Fail(Quote(marker.name) +
                            " is a marker of the robot; those of a reference length stand by "
                            "themselves");
        }
      }
    }
    value.Get("markers").Expect(reference.markers[0] != reference.markers[1],
                                "two different markers");
    reference.length = kOneMm * value.Get("length_mm").Bounded();
    reference.sd = kOneMm * value.Get("sd_mm").Bounded();
    project.recording.reference_lengths.push_back(reference);
  }
}

}  // namespace

void ReadMarkers(const YamlValue& section, Project& project) {
  section.ExpectKeys({"reference", "clusters", "single"});
  if (const auto clusters = section.Find("clusters")) {
    for (const YamlValue& cluster : clusters->Items()) ReadCluster(cluster, project);
  }
  if (const auto single = section.Find("single")) {
    for (const YamlValue& marker : single->Items()) ReadSingle(marker, project);
  }
  if (project.markers.empty()) section.Fail("there is no marker; at least one was expected");
  const auto stands_still = [&](const Marker& marker) {
    return project.tree.links[marker.link].body == 0;
  };
  if (std::all_of(project.markers.begin(), project.markers.end(), stands_still)) {
    section.Fail("no joint moves any marker");
  }
  if (const auto reference = section.Find("reference")) ReadReference(*reference, project);
}

void ReadTorqueSensors(const YamlValue& section, Project& project) {
  for (const YamlValue& value : section.Items()) {
    const int joint = JointNamedBy(value, project.tree);
    for (int other : project.torque_sensors) {
      if (other == joint) value.Fail("the joint comes twice");
    }
    project.torque_sensors.push_back(joint);
  }
}

void ReadForceTorqueSensors(const YamlValue& section, Project& project) {
  for (const YamlValue& value : section.Items()) {
    value.ExpectKeys({"name", "link"});
    ForceTorqueSensor sensor;
    sensor.name = NewName(value.Get("name"), "sensor", project.force_torque_sensors);
    sensor.link = LinkNamedBy(value.Get("link"), project.tree);
    for (const ForceTorqueSensor& other : project.force_torque_sensors) {
      if (other.link == sensor.link) value.Fail("a second sensor on the same link");
    }
    project.force_torque_sensors.push_back(std::move(sensor));
  }
}

/// Gravity, from what points up: x, y, z, -x, -y, -z, or a direction [x, y, z].
Eigen::Vector3d ReadGravity(const YamlValue& up) {
  if (!up.IsScalar()) return -GravityBelow("z").norm() * DirectionFrom(up);
  up.Expect(IsAxis(up.Text()), "x, y, z, -x, -y, -z or three numbers");
  return GravityBelow(up.Text());
}

void ReadRecordingColumns(const YamlValue& section, Project& project) {
  section.ExpectKeys({"columns", "labels", "ignore", "root", "up", "not_recorded_deg",
                      "not_recorded_mm", "reference_lengths"});
  if (const auto root = section.Find("root")) {
    root->Expect(root->Text() == "held" || root->Text() == "free", "held or free");
    project.recording.free_root = root->Text() == "free";
    project.motion.free_root = project.recording.free_root;
  }
  if (const auto up = section.Find("up")) project.recording.gravity = ReadGravity(*up);
  if (const auto labels = section.Find("labels")) ReadLabels(*labels, project);
  if (const auto columns = section.Find("columns")) ReadColumns(*columns, project);
  if (const auto lengths = section.Find("reference_lengths")) {
    ReadReferenceLengths(*lengths, project);
  }
  if (const auto ignore = section.Find("ignore")) {
    for (const YamlValue& column : ignore->Items()) {
      project.recording.ignore.push_back(column.Text());
    }
  }
  if (const auto positions = section.Find("not_recorded_deg")) {
    ReadNotRecorded(*positions, JointType::kRevolute, kOneDegree, project);
  }
  if (const auto positions = section.Find("not_recorded_mm")) {
    ReadNotRecorded(*positions, JointType::kPrismatic, kOneMm, project);
  }
}

}  // namespace elastocal
