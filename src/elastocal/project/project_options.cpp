// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <set>

#include "elastocal/project/project_sections.hpp"

namespace elastocal {
namespace {

constexpr double kMicro = 1e-6;

void ReadPrior(const YamlValue& section, Prior& prior) {
  struct Entry {
    const char* key;
    ParameterKind kind;
    double unit;
  };
  static constexpr Entry kEntries[] = {
      {"theta_deg", ParameterKind::kTheta, kOneDegree},
      {"gamma_deg", ParameterKind::kGamma, kOneDegree},
      {"alpha_deg", ParameterKind::kAlpha, kOneDegree},
      {"beta_deg", ParameterKind::kBeta, kOneDegree},
      {"r_mm", ParameterKind::kR, kOneMm},
      {"d_mm", ParameterKind::kD, kOneMm},
      {"b_mm", ParameterKind::kB, kOneMm},
      {"marker_mm", ParameterKind::kMarker, kOneMm},
      {"torsion_urad_per_Nm", ParameterKind::kTorsion, kMicro},
      {"bending_urad_per_Nm", ParameterKind::kBending, kMicro},
      {"base_force_um_per_N", ParameterKind::kLegForce, kMicro},
      {"base_moment_urad_per_Nm", ParameterKind::kLegMoment, kMicro},
      {"torque_bias_Nm", ParameterKind::kTorqueBias, 1.0},
  };
  std::vector<std::string> keys;
  for (const Entry& entry : kEntries) keys.emplace_back(entry.key);
  keys.emplace_back("deflection_mrad");
  keys.emplace_back("deflection_mm");
  section.ExpectKeys(keys);
  section.ReadBounded("deflection_mrad", prior.deflection, 1e-3);
  section.ReadBounded("deflection_mm", prior.slide_deflection, kOneMm);
  for (const Entry& entry : kEntries) {
    section.ReadBounded(entry.key, prior[entry.kind], entry.unit);
  }
}

/// Reads one of a few words, if the section has the key.
template <typename Enum>
void ReadChoice(const YamlValue& section, const char* key, Enum& option,
                const std::vector<std::pair<std::string, Enum>>& choices) {
  const auto value = section.Find(key);
  if (!value) return;
  std::vector<std::string> words;
  std::string listed;
  for (const auto& [word, meaning] : choices) {
    if (value->Text() == word) {
      option = meaning;
      return;
    }
    words.push_back(word);
    listed += (listed.empty() ? "" : " or ") + word;
  }
  value->Fail("unknown word '" + value->Text() + "'" + DidYouMean(value->Text(), words) +
              "; expected " + listed);
}

/// Reads patterns of names of joints, each of which must match a joint.
void ReadPatterns(const YamlValue& section, const char* key, const RobotTree& tree,
                  std::optional<std::vector<std::string>>& patterns) {
  const auto list = section.Find(key);
  if (!list) return;
  patterns.emplace();
  for (const YamlValue& value : list->Items()) {
    patterns->push_back(value.Text());
    if (MatchingJoints(tree, {value.Text()}).empty()) {
      value.Fail("no joint matches '" + value.Text() + "'");
    }
  }
}

/// Reads `auto`, `none`, or a list of causes.
void ReadExtra(const YamlValue& value, ExtraCauses& extra) {
  extra.automatic = false;
  if (!value.IsScalar()) {
    for (const YamlValue& name : value.Items()) extra.names.push_back(name.Text());
    return;
  }
  extra.automatic = value.Text() == "auto";
  value.Expect(extra.automatic || value.Text() == "none", "auto, none or a list of causes");
}

/// Reads `prior`, `nominal_markers`, or "link NAME" with a link that a joint on the root link
/// carries.
void ReadGauge(const YamlValue& value, const RobotTree& tree, Gauge& gauge) {
  constexpr std::string_view kLinkWord = "link ";
  const std::string text = value.Text();
  if (text.starts_with(kLinkWord)) {
    gauge = {GaugeRule::kLink, text.substr(kLinkWord.size())};
    const int body =
        tree.links[FindNamedBy(value, [&] { return FindLink(tree, gauge.link); })].body;
    value.Expect(body > 0 && tree.joints[body - 1].parent_body == 0,
                 "a link that a joint on the root link carries");
    return;
  }
  value.Expect(text == "prior" || text == "nominal_markers",
               "prior, nominal_markers, or link and the name of a link on the root link");
  gauge.rule = text == "prior" ? GaugeRule::kPrior : GaugeRule::kNominalMarkers;
}

}  // namespace

std::vector<int> MatchingJoints(const RobotTree& tree, const std::vector<std::string>& patterns) {
  std::vector<Parameter> names;
  for (const Joint& joint : tree.joints) {
    names.push_back({joint.name, ParameterKind::kTheta, ParameterUnit::kRadian});
  }
  return MatchParameters(names, patterns);
}

void CheckHasMarkers(const Project& project) {
  if (!project.markers.empty()) return;
  throw InputError(
      project.file.string() +
      ": the project has no markers, which this command is about; with contact or instruments "
      "alone there are calibrate, validate, check, compare, diagnose, design, plan, simulate, "
      "export "
      "and report");
}

void ReadPlacementOptions(const YamlValue& section, PlacementOptions& options) {
  section.ExpectKeys({"parallel_tolerance_deg"});
  section.ReadBounded("parallel_tolerance_deg", options.parallel_tolerance_rad, kOneDegree);
}

void ReadMeasurementOptions(const YamlValue& section, MeasurementOptions& options) {
  section.ExpectKeys({"cutoff_hz", "filter_order", "longest_gap_s", "expected_lag_s",
                      "longest_lag_s", "largest_lag_sd_ms", "largest_rest_lag_sd_ms",
                      "rest_speed_mm_per_s", "hold_s", "samples_per_rest", "sine_rate_hz"});
  constexpr double kMillisecond = 1e-3;
  section.ReadBounded("cutoff_hz", options.smoothing.cutoff_hz);
  section.ReadBounded("filter_order", options.smoothing.filter_order);
  section.ReadBounded("longest_gap_s", options.smoothing.longest_fill_s);
  if (const auto lag = section.Find("expected_lag_s")) options.expected_lag_s = lag->Bounded();
  section.ReadBounded("longest_lag_s", options.clock.longest_lag_s);
  section.ReadBounded("largest_lag_sd_ms", options.clock.largest_sd_s, kMillisecond);
  section.ReadBounded("largest_rest_lag_sd_ms", options.largest_rest_lag_sd_s, kMillisecond);
  section.ReadBounded("rest_speed_mm_per_s", options.rest.threshold_m_per_s, kOneMm);
  section.ReadBounded("hold_s", options.rest.hold_s);
  section.ReadBounded("samples_per_rest", options.rest.samples_per_run);
  section.ReadBounded("sine_rate_hz", options.sine_rate_hz);
}

void ReadIdentifiabilityOptions(const YamlValue& section, IdentifiabilityOptions& options) {
  section.ExpectKeys({"postures", "tolerance", "seed", "hold"});
  section.ReadBounded("postures", options.postures);
  section.ReadBounded("tolerance", options.tolerance);
  if (const auto seed = section.Find("seed")) {
    options.seed =
        static_cast<std::uint64_t>(seed->Integer(0, std::numeric_limits<std::int64_t>::max()));
  }
  if (const auto hold = section.Find("hold")) {
    for (const YamlValue& pattern : hold->Items()) options.hold.push_back(pattern.Text());
  }
}

void ReadCalibrationOptions(const YamlValue& section, const RobotTree& tree,
                            CalibrationOptions& options) {
  section.ExpectKeys({"prior", "widen_prior", "marker_sd_mm", "plausible_marker_sd_mm",
                      "outlier_probability", "support_threshold", "correlation_threshold",
                      "max_iterations", "support", "load", "extra", "slip_mm", "outliers",
                      "floor_tilt_deg", "floor_height_mm", "drift", "gauge"});
  if (const auto prior = section.Find("prior")) ReadPrior(*prior, options.prior);
  section.Read("widen_prior", options.widen_prior);
  section.ReadBounded("marker_sd_mm", options.marker_sd, kOneMm);
  section.ReadBounded("plausible_marker_sd_mm", options.plausible_marker_sd, kOneMm);
  section.ReadBounded("outlier_probability", options.outlier_probability);
  section.ReadBounded("support_threshold", options.support_threshold);
  section.ReadBounded("drift", options.drift);
  section.ReadBounded("correlation_threshold", options.correlation_threshold);
  ReadChoice<SupportForm>(
      section, "support", options.support_form,
      {{"nuisance", SupportForm::kNuisance}, {"foot_rooted", SupportForm::kFootRooted}});
  ReadChoice<OutlierPolicy>(section, "outliers", options.outliers,
                            {{"remove", OutlierPolicy::kRemove}, {"keep", OutlierPolicy::kKeep}});
  ReadChoice<LoadSource>(section, "load", options.load.source,
                         {{"torques", LoadSource::kTorques},
                          {"wrench", LoadSource::kWrench},
                          {"statics", LoadSource::kStatics}});
  if (const auto extra = section.Find("extra")) ReadExtra(*extra, options.extra);
  if (const auto gauge = section.Find("gauge")) ReadGauge(*gauge, tree, options.gauge);
  section.ReadBounded("slip_mm", options.slip, kOneMm);
  section.ReadBounded("floor_tilt_deg", options.floor_tilt_sd, kOneDegree);
  section.ReadBounded("floor_height_mm", options.floor_height_sd, kOneMm);
  section.ReadBounded("max_iterations", options.max_iterations);
}

void ReadElasticity(const YamlValue& section, Project& project) {
  ElasticityChoice& choice = project.elasticity;
  section.ExpectKeys({"torsion", "bending", "base", "torque_bias"});
  ReadPatterns(section, "torsion", project.tree, choice.torsion);
  ReadPatterns(section, "bending", project.tree, choice.bending);
  section.Read("base", choice.base);
  section.Read("torque_bias", choice.torque_bias);
}

ErrorModel MakeProjectModel(const Project& project, const std::vector<Trial>& trials) {
  CheckHasMarkers(project);
  std::set<int> standing, on_floor;  // links on which a trial stands alone; joints of any support
  for (const Trial& trial : trials) {
    if (trial.support.size() == 1) standing.insert(trial.support[0]);
    for (int link : trial.support) {
      for (int joint : JointsToBody(project.tree, project.tree.links[link].body)) {
        on_floor.insert(joint);
      }
    }
  }
  Elasticity elasticity;
  elasticity.base = project.elasticity.base;
  elasticity.torque_bias = project.elasticity.torque_bias;
  if (!project.elasticity.extra.empty()) {
    std::vector<std::string> markers;
    for (const Marker& marker : project.markers) markers.push_back(marker.name);
    elasticity.corrections =
        CorrectionsOf(PossibleCorrections(project.tree, project.elasticity.hours, markers),
                      project.elasticity.extra);
  }
  for (const Chain& chain : project.chains) {
    if (!standing.contains(chain.tip_link)) continue;
    elasticity.legs.push_back({chain.name, chain.tip_link});
    standing.erase(chain.tip_link);  // a second chain to the same foot is the same leg
  }
  const bool trials_given = !trials.empty();
  const ElasticityChoice& choice = project.elasticity;
  if (choice.torsion || trials_given) {
    elasticity.torsion =
        MatchingJoints(project.tree, choice.torsion.value_or(std::vector<std::string>{"*"}));
  }
  std::vector<int> bending;
  if (choice.bending) {
    bending = MatchingJoints(project.tree, *choice.bending);
  } else {
    if (trials_given) on_floor.insert(elasticity.torsion.begin(), elasticity.torsion.end());
    bending.assign(on_floor.begin(), on_floor.end());
  }
  for (int joint : bending) {
    const Joint& bent = project.tree.joints[joint];
    if (bent.type != JointType::kRevolute) continue;
    elasticity.bending.push_back(joint);
    if (trials_given && choice.root_bending && bent.parent_body == 0) {
      elasticity.root_bending.push_back(joint);
    }
  }
  return MakeErrorModel(project.tree, project.markers, project.placement, elasticity);
}

}  // namespace elastocal
