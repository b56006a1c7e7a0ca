// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/experiment.hpp"

#include <algorithm>
#include <array>

#include <yaml-cpp/emitter.h>
#include <yaml-cpp/stlemitter.h>

#include "elastocal/files/output_files.hpp"
#include "elastocal/files/yaml_value.hpp"
#include "elastocal/io/recorded_files.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/project/project_sections.hpp"
#include "elastocal/readers/byte_source.hpp"
#include "elastocal/readers/lengths.hpp"
#include "elastocal/readers/times.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFileName = "experiment.yaml";
constexpr std::array kKinds = {TrialKind::kCalibration, TrialKind::kSine, TrialKind::kRandom,
                               TrialKind::kRepeatability};

template <typename Value>
bool Contains(const std::vector<Value>& values, const Value& value) {
  return std::find(values.begin(), values.end(), value) != values.end();
}

/// `chain: name` or `chains: [name, ...]`.
std::vector<int> ReadChains(const YamlValue& trial, const Project& project) {
  const auto one = trial.Find("chain");
  const auto list = trial.Find("chains");
  if (one.has_value() == list.has_value()) {
    trial.Fail(
        "the chains that the trial exercises: expected one of the keys 'chain' and "
        "'chains'");
  }
  if (one) return {ChainNamedBy(*one, project)};
  std::vector<int> chains;
  for (const YamlValue& value : list->Items()) {
    const int chain = ChainNamedBy(value, project);
    if (Contains(chains, chain)) value.Fail("the chain comes twice");
    chains.push_back(chain);
  }
  if (chains.empty()) list->Fail("found no chain; one or more were expected");
  return chains;
}

/// Reads the supports. A support must be the tip of a chain, because only there the joints that
/// carry the robot are known.
void ReadSupport(const YamlValue& value, const Project& project, TrialFiles& trial) {
  if (value.IsScalar() && value.Text() == "free") {
    trial.free_root = true;
    return;
  }
  std::vector<std::string> tips;
  for (const Chain& chain : project.chains) {
    tips.push_back(project.tree.links[chain.tip_link].name);
  }
  for (const YamlValue& item : value.Items()) {
    const int link = LinkNamedBy(item, project.tree);
    const std::string& name = project.tree.links[link].name;
    if (!Contains(tips, name)) {
      item.Fail("link " + Quote(name) + " is not the tip of any chain of " + project.file.string() +
                DidYouMean(name.substr(0, 60), tips));
    }
    if (Contains(trial.support, link)) item.Fail("the link comes twice");
    trial.support.push_back(link);
  }
}

TrialKind ReadKind(const YamlValue& value) {
  const std::string text = value.Text();
  if (const auto kind = TrialKindNamed(text)) return *kind;
  std::vector<std::string> names;
  for (TrialKind kind : kKinds) names.push_back(TrialKindName(kind));
  value.Fail("found " + Quote(text) + "; expected calibration, sine, random or repeatability" +
             DidYouMean(text.substr(0, 60), names));
}

/// Adds the file to those that trials have named.
fs::path ReadFileName(const YamlValue& value, const fs::path& folder, std::vector<fs::path>& used) {
  const fs::path file = (folder / value.Text()).lexically_normal();
  std::error_code error;
  if (!fs::is_regular_file(file, error) && !IsBagFolder(file))
    value.Fail("there is no file " + file.string());
  if (Contains(used, file)) value.Fail("the file " + file.string() + " is named twice");
  used.push_back(file);
  return file;
}

TrialFiles ReadTrial(const YamlValue& value, const fs::path& folder, const Project& project,
                     std::vector<fs::path>& used) {
  value.ExpectKeys({"name", "kind", "samples", "chain", "chains", "support", "markers", "joints",
                    "markers_unit", "joints_time_unit", "joints_topic", "tf_frame", "tf_bodies",
                    "expected_lag_s", "truth"});
  TrialFiles trial;
  CheckFileName(value.Get("name"));
  trial.name = value.Get("name").Text();
  if (const auto kind = value.Find("kind")) trial.kind = ReadKind(*kind);
  if (const auto samples = value.Find("samples")) {
    trial.moments = samples->Text() == "motion";
    samples->Expect(trial.moments || samples->Text() == "rests", "rests or motion");
    samples->Expect(trial.moments || trial.kind != TrialKind::kSine, "motion, as in every sine");
  }
  trial.chains = ReadChains(value, project);
  if (const auto support = value.Find("support")) ReadSupport(*support, project, trial);
  trial.markers = ReadFileName(value.Get("markers"), folder, used);
  const YamlValue joints = value.Get("joints");
  // A bag may hold both.
  const bool one_file = (folder / joints.Text()).lexically_normal() == trial.markers;
  trial.joints = one_file ? trial.markers : ReadFileName(joints, folder, used);
  if (const auto unit = value.Find("markers_unit")) {
    trial.reading.unit = unit->Text();
    unit->Expect(MetresIn(trial.reading.unit) > 0.0, "mm, cm, m or in");
  }
  if (const auto unit = value.Find("joints_time_unit")) {
    trial.reading.time_unit = unit->Text();
    unit->Expect(SecondsIn(trial.reading.time_unit) > 0.0, "s, ms, us or ns");
  }
  if (const auto topic = value.Find("joints_topic")) trial.reading.joints_topic = topic->Text();
  if (const auto frame = value.Find("tf_frame")) trial.reading.tf_frame = frame->Text();
  if (const auto bodies = value.Find("tf_bodies")) {
    for (const YamlValue& body : bodies->Items()) trial.reading.tf_bodies.push_back(body.Text());
  }
  if (const auto lag = value.Find("expected_lag_s")) trial.expected_lag_s = lag->Bounded();
  if (const auto truth = value.Find("truth")) trial.truth = ReadFileName(*truth, folder, used);
  return trial;
}

/// The axis of the cameras' frame that points up.
Eigen::Vector3d ReadGravity(const YamlValue& up) {
  up.Expect(IsAxis(up.Text()), "x, y, z, -x, -y or -z");
  return GravityBelow(up.Text());
}

/// The axis again; empty for the default.
std::string UpOf(const Experiment& experiment) {
  for (const char* axis : {"x", "y", "z", "-x", "-y", "-z"}) {
    if (experiment.gravity == GravityBelow(axis)) {
      return std::string(axis) == "z" && !experiment.up_given ? "" : axis;
    }
  }
  return "";
}

void EmitTrial(const TrialFiles& trial, const fs::path& folder, const Project& project,
               YAML::Emitter& yaml) {
  const auto emit = [&](const char* key, const std::string& value) {
    yaml << YAML::Key << key << YAML::Value << value;
  };
  yaml << YAML::BeginMap;
  emit("name", trial.name);
  emit("kind", TrialKindName(trial.kind));
  if (trial.moments) emit("samples", "motion");
  yaml << YAML::Key << "chains" << YAML::Value << YAML::Flow << YAML::BeginSeq;
  for (int chain : trial.chains) yaml << project.chains[chain].name;
  yaml << YAML::EndSeq;
  if (trial.free_root) {
    emit("support", "free");
  } else {
    yaml << YAML::Key << "support" << YAML::Value << YAML::Flow << YAML::BeginSeq;
    for (int link : trial.support) yaml << project.tree.links[link].name;
    yaml << YAML::EndSeq;
  }
  const auto emit_file = [&](const char* key, const fs::path& file) {
    emit(key, file.lexically_proximate(folder.lexically_normal()).generic_string());
  };
  emit_file("markers", trial.markers);
  emit_file("joints", trial.joints);
  if (!trial.reading.unit.empty()) emit("markers_unit", trial.reading.unit);
  if (!trial.reading.time_unit.empty()) emit("joints_time_unit", trial.reading.time_unit);
  if (!trial.reading.joints_topic.empty()) emit("joints_topic", trial.reading.joints_topic);
  if (!trial.reading.tf_frame.empty()) emit("tf_frame", trial.reading.tf_frame);
  if (!trial.reading.tf_bodies.empty()) {
    yaml << YAML::Key << "tf_bodies" << YAML::Value << YAML::Flow << trial.reading.tf_bodies;
  }
  if (trial.expected_lag_s) {
    yaml << YAML::Key << "expected_lag_s" << YAML::Value << FormatNumber(*trial.expected_lag_s);
  }
  if (!trial.truth.empty()) emit_file("truth", trial.truth);
  yaml << YAML::EndMap;
}

}  // namespace

std::string TrialKindName(TrialKind kind) {
  switch (kind) {
    case TrialKind::kCalibration:
      return "calibration";
    case TrialKind::kSine:
      return "sine";
    case TrialKind::kRandom:
      return "random";
    case TrialKind::kRepeatability:
      break;
  }
  return "repeatability";
}

std::optional<TrialKind> TrialKindNamed(const std::string& name) {
  for (TrialKind kind : kKinds) {
    if (TrialKindName(kind) == name) return kind;
  }
  return std::nullopt;
}

Experiment ReadExperiment(const fs::path& folder, const Project& project) {
  return ParseExperiment(ReadFile(folder / kFileName), folder, project);
}

Experiment ParseExperiment(const std::string& text, const fs::path& folder,
                           const Project& project) {
  const YamlValue root = YamlValue::Parse(text, (folder / kFileName).string());
  root.ExpectKeys({"up", "trials"});
  const YamlValue list = root.Get("trials");
  Experiment experiment;
  if (const auto up = root.Find("up")) {
    experiment.gravity = ReadGravity(*up);
    experiment.up_given = true;
  }
  std::vector<fs::path> used;
  for (const YamlValue& value : list.Items()) {
    TrialFiles trial = ReadTrial(value, folder, project, used);
    for (const TrialFiles& other : experiment.trials) {
      if (other.name == trial.name) value.Fail("a second trial of the name " + Quote(trial.name));
    }
    experiment.trials.push_back(std::move(trial));
  }
  if (experiment.trials.empty()) list.Fail("found no trial; one or more were expected");
  return experiment;
}

std::string FormatExperiment(const fs::path& folder, const Experiment& experiment,
                             const Project& project) {
  YAML::Emitter yaml;
  yaml << YAML::BeginMap;
  if (const std::string up = UpOf(experiment); !up.empty()) {
    yaml << YAML::Key << "up" << YAML::Value << up;
  }
  yaml << YAML::Key << "trials" << YAML::Value << YAML::BeginSeq;
  for (const TrialFiles& trial : experiment.trials) EmitTrial(trial, folder, project, yaml);
  yaml << YAML::EndSeq << YAML::EndMap;
  return std::string(yaml.c_str()) + "\n";
}

void WriteExperiment(const fs::path& folder, const Experiment& experiment, const Project& project) {
  WriteFile(folder / kFileName, FormatExperiment(folder, experiment, project));
}

}  // namespace elastocal
