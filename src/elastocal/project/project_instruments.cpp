// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>
#include <string>

#include "elastocal/math/decompositions.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/project/project_sections.hpp"

namespace elastocal {
namespace {

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

/// Reads the link and the point of an instrument that is about one point of a link.
template <typename Setup>
void ReadPointOfLink(const YamlValue& value, const Project& project, Setup& setup) {
  setup.name = InstrumentName(value, project);
  setup.link = LinkNamedBy(value.Get("link"), project.tree);
  setup.p_link = OptionalPoint(value, "point_mm");
  value.ReadBounded("mounting_sd_mm", setup.mounting_sd, kOneMm);
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

template <typename Of>
struct Named {
  std::string name;
  Of of;
};
using NamedTrackers = std::vector<Named<Tracker>>;
using NamedPlanes = std::vector<Named<int>>;

template <typename Of>
const Of& NamedBy(const YamlValue& value, const char* what, const std::vector<Named<Of>>& known) {
  std::vector<std::string> names;
  for (const Named<Of>& item : known) {
    if (item.name == value.Text()) return item.of;
    names.push_back(item.name);
  }
  value.Fail(std::string("there is no ") + what + " " + Quote(value.Text()) +
             DidYouMean(value.Text().substr(0, 60), names));
}

void ReadTracker(const YamlValue& value, Project& project, NamedTrackers& trackers) {
  value.ExpectKeys({"name", "carrier"});
  const std::string name = NewName(value.Get("name"), "tracker", trackers);
  const auto carrier = value.Find("carrier");
  const int link = carrier ? LinkNamedBy(*carrier, project.tree) : -1;
  trackers.push_back({name, AddTracker(project.contact->setup, name, link)});
}

Eigen::MatrixXd CovarianceOf(const YamlValue& list) {
  const std::vector<YamlValue> rows = list.Items();
  list.Expect(rows.size() == 6, "six rows of six numbers");
  Eigen::MatrixXd covariance(6, 6);
  for (int i = 0; i < 6; ++i) covariance.row(i) = NumbersOf(rows[i], 6).transpose();
  const double largest = covariance.cwiseAbs().maxCoeff();
  list.Expect((covariance - covariance.transpose()).cwiseAbs().maxCoeff() <= 1e-9 * largest,
              "a symmetric matrix");
  list.Expect(SymmetricValues(covariance)[0] > 0.0, "a positive definite matrix");
  return covariance;
}

void ReadPose(const YamlValue& value, const NamedTrackers& trackers, Project& project) {
  value.ExpectKeys({"name", "link", "tracker", "xyz_mm", "rpy_deg", "mounting_sd_mm",
                    "mounting_sd_deg", "covariance", "columns"});
  TrackedBodySetup body;
  body.name = InstrumentName(value, project);
  body.link = LinkNamedBy(value.Get("link"), project.tree);
  body.tracker = NamedBy(value.Get("tracker"), "tracker", trackers);
  body.T_link = PoseFromMm(value);
  value.ReadBounded("mounting_sd_mm", body.mounting_sd_m, kOneMm);
  value.ReadBounded("mounting_sd_deg", body.mounting_sd_rad, kOneDegree);
  if (const auto covariance = value.Find("covariance")) body.covariance = CovarianceOf(*covariance);
  AddTrackedBody(project.contact->setup, body);
  TakeColumns(value, {"_x", "_y", "_z", "_qx", "_qy", "_qz", "_qw"}, project);
}

void ReadPosition(const YamlValue& value, const NamedTrackers& trackers, Project& project) {
  value.ExpectKeys({"name", "link", "tracker", "point_mm", "mounting_sd_mm", "columns"});
  TrackedPointSetup point;
  ReadPointOfLink(value, project, point);
  point.tracker = NamedBy(value.Get("tracker"), "tracker", trackers);
  AddTrackedPoint(project.contact->setup, point);
  TakeColumns(value, {"_x", "_y", "_z"}, project);
}

void ReadInertialUnit(const YamlValue& value, Project& project) {
  value.ExpectKeys({"name", "link", "rpy_deg", "mounting_sd_deg", "bias_sd_m_per_s2", "columns"});
  InertialUnitSetup unit;
  unit.name = InstrumentName(value, project);
  unit.link = LinkNamedBy(value.Get("link"), project.tree);
  unit.R_link_unit = PoseFromMm(value).linear();
  value.ReadBounded("mounting_sd_deg", unit.mounting_sd, kOneDegree);
  value.ReadBounded("bias_sd_m_per_s2", unit.bias_sd);
  AddInertialUnit(project.contact->setup, unit);
  TakeColumns(value, {"_ax", "_ay", "_az"}, project);
}

void ReadPlane(const YamlValue& value, Project& project, NamedPlanes& planes) {
  value.ExpectKeys({"name", "normal"});
  const std::string name = NewName(value.Get("name"), "plane", planes);
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  if (const auto given = value.Find("normal")) {
    normal = NumbersOf(*given, 3);
    given->Expect(normal.norm() > 0.0, "a direction");
  }
  planes.push_back({name, AddPlane(project.contact->setup, name, normal)});
}

void ReadDistance(const YamlValue& value, const NamedPlanes& planes, Project& project) {
  value.ExpectKeys({"name", "link", "plane", "point_mm", "mounting_sd_mm", "columns"});
  PlaneDistanceSetup distance;
  ReadPointOfLink(value, project, distance);
  distance.plane = NamedBy(value.Get("plane"), "plane", planes);
  AddPlaneDistance(project.contact->setup, distance);
  TakeColumns(value, {""}, project);
}

void ReadWire(const YamlValue& value, Project& project) {
  value.ExpectKeys({"name", "link", "point_mm", "anchor_mm", "anchor_sd_mm", "zero_sd_mm",
                    "mounting_sd_mm", "columns"});
  WireSetup wire;
  ReadPointOfLink(value, project, wire);
  wire.p_floor = PointFromMm(value.Get("anchor_mm"));
  value.ReadBounded("anchor_sd_mm", wire.anchor_sd, kOneMm);
  value.ReadBounded("zero_sd_mm", wire.zero_sd, kOneMm);
  AddWire(project.contact->setup, wire);
  TakeColumns(value, {""}, project);
}

/// Checks that all quantities and sources have different names, by which they are identified, also
/// in the files of a calibration.
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

}  // namespace

std::vector<YamlValue> InstrumentList(const YamlValue& section, const char* key) {
  const auto list = section.Find(key);
  if (!list) return {};
  std::vector<YamlValue> items = list->Items();
  list->Expect(items.size() <= kMostInstruments, "at most 1000 of them");
  return items;
}

void ReadInstruments(const YamlValue& section, Project& project) {
  section.ExpectKeys({"trackers", "poses", "positions", "inertial_units", "planes", "distances",
                      "wires", "cameras", "tags"});
  if (!project.contact) project.contact.emplace();
  NamedTrackers trackers;
  NamedPlanes planes;
  for (const YamlValue& value : InstrumentList(section, "trackers"))
    ReadTracker(value, project, trackers);
  for (const YamlValue& value : InstrumentList(section, "planes"))
    ReadPlane(value, project, planes);
  for (const YamlValue& value : InstrumentList(section, "poses"))
    ReadPose(value, trackers, project);
  for (const YamlValue& value : InstrumentList(section, "positions")) {
    ReadPosition(value, trackers, project);
  }
  for (const YamlValue& value : InstrumentList(section, "inertial_units")) {
    ReadInertialUnit(value, project);
  }
  for (const YamlValue& value : InstrumentList(section, "distances"))
    ReadDistance(value, planes, project);
  for (const YamlValue& value : InstrumentList(section, "wires")) ReadWire(value, project);
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
