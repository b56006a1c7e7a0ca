// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>
#include <yaml-cpp/emitter.h>

#include "elastocal/io/recording_columns.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/planning/simulate_observations.hpp"
#include "elastocal/planning/truth_file.hpp"
#include "elastocal/tables/json_text.hpp"
#include "elastocal/tables/table_writer.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

std::string FrameName(std::size_t posture) { return std::to_string(posture + 1); }

std::string ObservationTable(const Project& project, const ObservedRecording& recording) {
  const ContactProject& contact = *project.contact;
  TableWriter table;
  if (!contact.seen_tags.empty()) table.Add("frame");
  if (!contact.plate_column.empty()) table.Add(contact.plate_column);
  const bool session = contact.sessions.modulo == 0 && !contact.sessions.columns.empty();
  if (session) table.Add(contact.sessions.columns.front());
  for (int k : project.tree.coordinate_joint) {
    table.Add(JointColumn(project, project.tree.joints[Size(k)].name));
  }
  for (const auto& columns : contact.columns) {
    for (const std::string& column : columns) table.Add(column);
  }
  table.EndRow();
  for (std::size_t i = 0; i < recording.postures.size(); ++i) {
    const SimulatedPosture& of = recording.postures[i];
    const bool touches = of.plate >= 0;
    if (!contact.seen_tags.empty()) {
      table.Add(touches && contact.plate_column.empty() ? "" : FrameName(i));
    }
    if (!contact.plate_column.empty()) {
      table.Add(touches ? recording.setup.plates[Size(of.plate)].name : "");
    }
    if (session) table.Add("1");
    for (double position : of.encoders) table.Add(position);
    for (std::size_t n = 0; n < contact.columns.size(); ++n) {
      const bool shown = of.measured[n].size() > 0;
      for (std::size_t c = 0; c < contact.columns[n].size(); ++c) {
        table.Add(shown ? of.measured[n][static_cast<Eigen::Index>(c)] : kNaN);
      }
    }
    table.EndRow();
  }
  return table.text();
}

std::string CornerTable(const Project& project, const ObservedRecording& recording) {
  constexpr int kDecimals = 4;  // px
  TableWriter table;
  for (const char* column : {"frame", "camera", "tag", "corner", "u", "v"}) table.Add(column);
  table.EndRow();
  for (std::size_t i = 0; i < recording.postures.size(); ++i) {
    for (const TagInCamera& view : project.contact->seen_tags) {
      const Eigen::VectorXd& pixels = recording.postures[i].measured[Size(view.instrument)];
      for (Eigen::Index corner = 0; 2 * corner < pixels.size(); ++corner) {
        table.Add(FrameName(i));
        table.Add(view.camera);
        table.Add(view.tag);
        table.Add(std::to_string(corner));
        table.AddFixed(pixels[2 * corner], kDecimals);
        table.AddFixed(pixels[2 * corner + 1], kDecimals);
        table.EndRow();
      }
    }
  }
  return table.text();
}

/// The truth beside the robot, in the form in which summary.json has the estimates.
std::string QuantitiesYaml(const ObservedRecording& recording) {
  YAML::Emitter yaml;
  const auto list = [&](const char* key, const auto& values) {
    yaml << YAML::Key << key << YAML::Value << YAML::Flow << YAML::BeginSeq;
    for (const double value : values) yaml << FormatNumber(value);
    yaml << YAML::EndSeq;
  };
  yaml << YAML::BeginMap << YAML::Key << "quantities" << YAML::Value << YAML::BeginMap;
  for (std::size_t i = 0; i < recording.quantities.size(); ++i) {
    const QuantityValue& value = recording.quantities[i];
    yaml << YAML::Key << recording.setup.quantities[i].name << YAML::Value << YAML::BeginMap;
    list("origin_xyz_m", Eigen::Vector3d(value.origin.translation()));
    list("origin_rpy_rad", ToRpy(value.origin.linear(), Eigen::Vector3d::Zero()));
    list("values", value.x);
    yaml << YAML::EndMap;
  }
  yaml << YAML::EndMap << YAML::EndMap;
  return std::string(yaml.c_str()) + "\n";
}

}  // namespace

std::vector<std::filesystem::path> FilesOfObservedSimulation(const Project& project,
                                                             const std::filesystem::path& folder,
                                                             bool force) {
  std::vector<std::filesystem::path> files = {folder / "observations.csv", folder / "truth.yaml"};
  if (!project.contact->seen_tags.empty()) files.push_back(folder / "corners.csv");
  if (force || std::filesystem::exists(folder / "truth.yaml")) return files;
  for (const std::filesystem::path& file : files) {
    if (!std::filesystem::exists(file)) continue;
    throw InputError(file.string() +
                     ": is there and was not simulated (there is no truth.yaml beside it), so it "
                     "is not replaced; choose another folder, or give --force");
  }
  return files;
}

std::map<std::string, std::string> FormatObservedRecording(const Project& project,
                                                           const ObservedRecording& recording) {
  std::map<std::string, std::string> files;
  files["observations.csv"] = ObservationTable(project, recording);
  if (!project.contact->seen_tags.empty()) {
    files["corners.csv"] = CornerTable(project, recording);
  }
  files["truth.yaml"] = FormatTruth(recording.robot, {}, {}) + QuantitiesYaml(recording);
  return files;
}

std::string FormatObservedSimulation(const ObservedRecording& recording) {
  nlohmann::ordered_json json;
  json["postures"] = recording.postures.size();
  int touches = 0;
  for (const SimulatedPosture& of : recording.postures) touches += of.plate >= 0 ? 1 : 0;
  json["touches"] = touches;
  json["warnings"] = recording.warnings;
  return JsonText(json);
}

}  // namespace elastocal
