#include <algorithm>

#include "elastocal/io/project_sections.hpp"
#include "elastocal/io/text.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kSmallestCluster = 3;

Eigen::Vector3d ReadPosition(const YamlValue& value) {
  const std::vector<YamlValue> coordinates = value.Items();
  if (coordinates.size() != 3) {
    value.Fail("found " + std::to_string(coordinates.size()) +
               (coordinates.size() == 1 ? " number" : " numbers") +
               "; expected three coordinates [x, y, z] in mm");
  }
  Eigen::Vector3d position;
  for (int i = 0; i < 3; ++i) position[i] = kMetresPerMm * coordinates[i].Number();
  return position;
}

void AddMarker(const YamlValue& where, const std::string& name, int link,
               const Eigen::Vector3d& position, Project& project) {
  for (const Marker& marker : project.markers) {
    if (marker.name == name) where.Fail("a second marker of the name " + Quote(name));
  }
  constexpr std::size_t kMostMarkers = 1000;
  if (project.markers.size() >= kMostMarkers) where.Fail("more than 1000 markers");
  project.markers.push_back({name, link, position});
}

void ReadCluster(const YamlValue& value, Project& project) {
  value.ExpectKeys({"name", "link", "positions_mm"});
  MarkerCluster cluster;
  cluster.name = value.Get("name").Text();
  for (const MarkerCluster& other : project.clusters) {
    if (other.name == cluster.name) {
      value.Fail("a second cluster of the name " + Quote(cluster.name));
    }
  }
  cluster.link = LinkNamedBy(value.Get("link"), project.tree);
  const YamlValue list = value.Get("positions_mm");
  const std::vector<YamlValue> positions = list.Items();
  list.Expect(positions.size() >= kSmallestCluster,
              "at least three positions; fewer markers go to markers.single");
  for (std::size_t i = 0; i < positions.size(); ++i) {
    cluster.markers.push_back(static_cast<int>(project.markers.size()));
    AddMarker(positions[i], cluster.name + "_" + std::to_string(i + 1), cluster.link,
              ReadPosition(positions[i]), project);
  }
  project.clusters.push_back(std::move(cluster));
}

void ReadSingle(const YamlValue& value, Project& project) {
  value.ExpectKeys({"name", "link", "position_mm"});
  const YamlValue name = value.Get("name");
  AddMarker(name, name.Text(), LinkNamedBy(value.Get("link"), project.tree),
            ReadPosition(value.Get("position_mm")), project);
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

}  // namespace elastocal
