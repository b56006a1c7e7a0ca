#include <algorithm>
#include <cmath>

#include "elastocal/io/project_sections.hpp"
#include "elastocal/io/text.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

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

/// Positions of joints of one type; `unit` is what one of the file's units is in rad or m.
void ReadNotRecorded(const YamlValue& section, JointType type, double unit, Project& project) {
  for (const auto& [name, value] : section.Entries()) {
    const int joint = DriverNamedBy(name, value, project.tree);
    if (project.tree.joints[joint].type != type) {
      value.Fail(type == JointType::kRevolute
                     ? "the joint is prismatic: give it in not_recorded_mm"
                     : "the joint is revolute: give it in not_recorded_deg");
    }
    project.recording.not_recorded[name] = unit * value.Number();
  }
}

}  // namespace

void ReadRecordingColumns(const YamlValue& section, Project& project) {
  section.ExpectKeys({"columns", "ignore", "not_recorded_deg", "not_recorded_mm"});
  if (const auto columns = section.Find("columns")) ReadColumns(*columns, project);
  if (const auto ignore = section.Find("ignore")) {
    for (const YamlValue& column : ignore->Items()) {
      project.recording.ignore.push_back(column.Text());
    }
  }
  if (const auto positions = section.Find("not_recorded_deg")) {
    ReadNotRecorded(*positions, JointType::kRevolute, M_PI / 180.0, project);
  }
  if (const auto positions = section.Find("not_recorded_mm")) {
    ReadNotRecorded(*positions, JointType::kPrismatic, 1e-3, project);
  }
}

}  // namespace elastocal
