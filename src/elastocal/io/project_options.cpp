#include <cmath>
#include <limits>

#include "elastocal/io/project_sections.hpp"
#include "elastocal/io/text.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

constexpr double kMicro = 1e-6;

/// A number above 0 and below 1.
double Fraction(const YamlValue& value) {
  const double fraction = value.Number();
  value.Expect(fraction > 0.0 && fraction < 1.0, "a number above 0 and below 1");
  return fraction;
}

/// A number above 0 and at most 1.
double Threshold(const YamlValue& value) {
  const double threshold = value.Number();
  value.Expect(threshold > 0.0 && threshold <= 1.0, "a number above 0 and at most 1");
  return threshold;
}

void ReadPrior(const YamlValue& section, Prior& prior) {
  struct Entry {
    const char* key;
    ParameterKind kind;
    double unit;
  };
  static constexpr Entry kEntries[] = {
      {"theta_deg", ParameterKind::kTheta, kRadiansPerDegree},
      {"gamma_deg", ParameterKind::kGamma, kRadiansPerDegree},
      {"alpha_deg", ParameterKind::kAlpha, kRadiansPerDegree},
      {"beta_deg", ParameterKind::kBeta, kRadiansPerDegree},
      {"r_mm", ParameterKind::kR, kMetresPerMm},
      {"d_mm", ParameterKind::kD, kMetresPerMm},
      {"b_mm", ParameterKind::kB, kMetresPerMm},
      {"marker_mm", ParameterKind::kMarker, kMetresPerMm},
      {"torsion_urad_per_Nm", ParameterKind::kTorsion, kMicro},
      {"bending_urad_per_Nm", ParameterKind::kBending, kMicro},
      {"base_force_um_per_N", ParameterKind::kBaseForce, kMicro},
      {"base_moment_urad_per_Nm", ParameterKind::kBaseMoment, kMicro},
      {"torque_bias_Nm", ParameterKind::kTorqueBias, 1.0},
  };
  std::vector<std::string> keys;
  for (const Entry& entry : kEntries) keys.emplace_back(entry.key);
  section.ExpectKeys(keys);
  for (const Entry& entry : kEntries) {
    if (const auto sd = section.Find(entry.key)) {
      prior[entry.kind] = entry.unit * sd->PositiveOrInfinity();
    }
  }
}

std::string Listed(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) text += (i == 0 ? "" : " or ") + words[i];
  return text;
}

/// One of a few words.
template <typename Enum>
Enum Choice(const YamlValue& value, const std::vector<std::pair<std::string, Enum>>& choices) {
  std::vector<std::string> words;
  for (const auto& [word, meaning] : choices) {
    if (value.Text() == word) return meaning;
    words.push_back(word);
  }
  value.Fail("unknown word '" + value.Text() + "'" + DidYouMean(value.Text(), words) +
             "; expected " + Listed(words));
}

}  // namespace

void ReadPlacementOptions(const YamlValue& section, PlacementOptions& options) {
  section.ExpectKeys({"parallel_tolerance_deg"});
  if (const auto tolerance = section.Find("parallel_tolerance_deg")) {
    const double degrees = tolerance->Number();
    tolerance->Expect(degrees > 0.0 && degrees < 45.0, "an angle above 0 and below 45 degrees");
    options.parallel_tolerance_rad = kRadiansPerDegree * degrees;
  }
}

void ReadIdentifiabilityOptions(const YamlValue& section, IdentifiabilityOptions& options) {
  section.ExpectKeys({"postures", "tolerance", "seed", "hold"});
  if (const auto postures = section.Find("postures")) {
    options.postures = static_cast<int>(postures->Integer(1, 1000000));
  }
  if (const auto tolerance = section.Find("tolerance")) options.tolerance = Fraction(*tolerance);
  if (const auto seed = section.Find("seed")) {
    options.seed =
        static_cast<std::uint64_t>(seed->Integer(0, std::numeric_limits<std::int64_t>::max()));
  }
  if (const auto hold = section.Find("hold")) {
    for (const YamlValue& pattern : hold->Items()) options.hold.push_back(pattern.Text());
  }
}

void ReadCalibrationOptions(const YamlValue& section, CalibrationOptions& options) {
  section.ExpectKeys({"prior", "widen_prior", "marker_sd_mm", "plausible_marker_sd_mm",
                      "outlier_probability", "support_threshold", "correlation_threshold",
                      "max_iterations", "support", "load", "slip_mm"});
  if (const auto prior = section.Find("prior")) ReadPrior(*prior, options.prior);
  if (const auto widen = section.Find("widen_prior")) options.widen_prior = widen->Boolean();
  if (const auto sd = section.Find("marker_sd_mm")) {
    sd->Expect(sd->Number() >= 0.0, "a number of at least 0");
    options.marker_sd = kMetresPerMm * sd->Number();
  }
  if (const auto sd = section.Find("plausible_marker_sd_mm")) {
    options.plausible_marker_sd = kMetresPerMm * sd->PositiveOrInfinity();
  }
  if (const auto probability = section.Find("outlier_probability")) {
    options.outlier_probability = Fraction(*probability);
  }
  if (const auto threshold = section.Find("support_threshold")) {
    options.support_threshold = Threshold(*threshold);
  }
  if (const auto threshold = section.Find("correlation_threshold")) {
    options.correlation_threshold = Threshold(*threshold);
  }
  if (const auto form = section.Find("support")) {
    options.support_form = Choice<SupportForm>(*form, {{"nuisance", SupportForm::kNuisance},
                                                       {"foot_rooted", SupportForm::kFootRooted},
                                                       {"penalty", SupportForm::kPenalty}});
  }
  if (const auto load = section.Find("load")) {
    options.load.source = Choice<LoadSource>(*load, {{"torques", LoadSource::kTorques},
                                                     {"wrench", LoadSource::kWrench},
                                                     {"statics", LoadSource::kStatics}});
  }
  if (const auto slip = section.Find("slip_mm")) {
    options.slip = kMetresPerMm * slip->PositiveOrInfinity();
  }
  if (const auto iterations = section.Find("max_iterations")) {
    options.max_iterations = static_cast<int>(iterations->Integer(1, 1000000));
  }
}

}  // namespace elastocal
