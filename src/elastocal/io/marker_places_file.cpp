// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/marker_places_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "elastocal/files/bounds.hpp"
#include "elastocal/io/known_names.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/table_reader.hpp"
#include "elastocal/tables/table_writer.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr double kMillimetre = 1e-3;  // m
constexpr std::array kPlaceColumns = {"marker", "x_mm", "y_mm", "z_mm", "sd_mm", "link"};
enum PlaceColumn { kMarker, kX, kY, kZ, kSd, kLink };

double BoundedCell(const Table& table, int column, const std::string& key) {
  const double value = table.Number(column);
  const NumberRange range = BoundsOf(key);
  if (!range.Contains(value)) {
    table.FailCell(column, "found " + FormatNumber(value) + "; expected " + range.InWords());
  }
  return kMillimetre * value;
}

const Marker& MarkerOf(const Table& table, int column, const Project& project) {
  const std::string name(table.Cell(column));
  const auto found = std::ranges::find(project.markers, name, &Marker::name);
  if (found != project.markers.end()) return *found;
  std::vector<std::string> names;
  for (const Marker& marker : project.markers) names.push_back(marker.name);
  table.FailCell(column, "there is no marker " + Quote(name.substr(0, 60)) + Known(name, names));
}

/// Transform from the frame of the link that a row names to that of the marker's link; both links
/// must be on one body.
Transform FromNamedLink(const Table& table, int column, const Marker& marker,
                        const Project& project) {
  if (column < 0 || table.Cell(column).empty()) return Transform::Identity();
  const std::string name(table.Cell(column));
  const std::vector<Link>& links = project.tree.links;
  const auto found = std::ranges::find(links, name, &Link::name);
  if (found == links.end()) {
    std::vector<std::string> names;
    for (const Link& link : links) names.push_back(link.name);
    table.FailCell(column, "there is no link " + Quote(name.substr(0, 60)) + Known(name, names));
  }
  const Link& own = links[static_cast<std::size_t>(marker.link)];
  if (found->body != own.body) {
    table.FailCell(column, "a joint lies between link " + Quote(name) + " and " + Quote(own.name) +
                               ", which carries marker " + Quote(marker.name) +
                               "; a link that fixed joints join to it was expected");
  }
  return own.T_body_link.inverse() * found->T_body_link;
}

/// Refuses places in m: read as mm, they would all be near the origins of their links.
void CheckUnit(const std::vector<MarkerMeasurement>& places, const Project& project,
               const std::string& source) {
  constexpr double kSmall = 2e-3, kNominal = 2e-2;  // m
  int far = 0;
  for (const MarkerMeasurement& place : places) {
    if (place.p_link_marker.norm() > kSmall) return;
    const auto marker = std::ranges::find(project.markers, place.marker, &Marker::name);
    if (marker->p_link_marker.norm() > kNominal) ++far;
  }
  if (far == 0) return;
  throw InputError(source +
                   ": all places are within 2 mm of the origins of their links, where the project "
                   "has none; numbers in mm were expected, these seem to be in m");
}

}  // namespace

std::vector<MarkerMeasurement> ReadMarkerPlaces(const std::filesystem::path& file,
                                                const Project& project) {
  std::istringstream stream = OpenTable(file);
  Table table(stream, file.string());
  ColumnRoles roles;
  for (std::size_t i = 0; i < kPlaceColumns.size(); ++i) {
    roles[kPlaceColumns[i]] = static_cast<int>(i);
  }
  const std::vector<int> columns = FindColumns(table, roles, kPlaceColumns.size(),
                                               "marker, x_mm, y_mm, z_mm, sd_mm and link are read");
  for (const int needed : {kMarker, kX, kY, kZ, kSd}) {
    if (columns[static_cast<std::size_t>(needed)] >= 0) continue;
    table.Fail("there is no column '" +
               std::string(kPlaceColumns[static_cast<std::size_t>(needed)]) +
               "'; marker,x_mm,y_mm,z_mm,sd_mm was expected");
  }
  std::vector<MarkerMeasurement> places;
  while (table.Next()) {
    const Marker& marker = MarkerOf(table, columns[kMarker], project);
    for (const MarkerMeasurement& other : places) {
      if (other.marker == marker.name) {
        table.FailCell(columns[kMarker], "marker " + Quote(marker.name) + " comes twice");
      }
    }
    Eigen::Vector3d place;
    for (const PlaceColumn column : {kX, kY, kZ}) {
      place[column - kX] = BoundedCell(table, columns[column], "marker places x_mm, y_mm, z_mm");
    }
    const Transform T = FromNamedLink(table, columns[kLink], marker, project);
    places.push_back(
        {marker.name, T * place, BoundedCell(table, columns[kSd], "marker places sd_mm")});
  }
  if (places.empty()) throw InputError(file.string() + ": there is no row with a place");
  CheckUnit(places, project, file.string());
  return places;
}

std::vector<std::string> WarnOfIdleMarkerPlaces(
    const std::vector<std::filesystem::path>& recordings) {
  std::vector<std::string> warnings;
  for (const std::filesystem::path& recording : recordings) {
    const bool is_folder = std::filesystem::is_directory(recording);
    const std::filesystem::path file =
        (is_folder ? recording : recording.parent_path()) / "marker_places.csv";
    if (!std::filesystem::is_regular_file(file)) continue;
    std::string warning = file.string() +
                          ": these measured places of markers lie beside the recording and are "
                          "not used; calibrate --marker-places takes them";
    if (std::count(warnings.begin(), warnings.end(), warning) == 0) {
      warnings.push_back(std::move(warning));
    }
  }
  return warnings;
}

std::string FormatMarkerPlaces(const std::vector<MarkerMeasurement>& places) {
  TableWriter table;
  for (const PlaceColumn column : {kMarker, kX, kY, kZ, kSd}) table.Add(kPlaceColumns[column]);
  table.EndRow();
  for (const MarkerMeasurement& place : places) {
    table.Add(place.marker);
    for (const double coordinate : place.p_link_marker) {
      table.AddFixed(coordinate / kMillimetre, 4);
    }
    table.Add(place.sd / kMillimetre);
    table.EndRow();
  }
  return table.text();
}

}  // namespace elastocal
