#include "elastocal/io/project_sections.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

/// A finite number above 0, or what `option` is without the key.
void ReadPositive(const YamlValue& section, const char* key, double& option, double unit = 1.0) {
  const auto value = section.Find(key);
  if (!value) return;
  value->Expect(value->Number() > 0.0, "a number above 0");
  option = unit * value->Number();
}

}  // namespace

void ReadMeasurementOptions(const YamlValue& section, MeasurementOptions& options) {
  section.ExpectKeys({"cutoff_hz", "filter_order", "longest_gap_s", "expected_lag_s",
                      "longest_lag_s", "largest_lag_sd_ms", "largest_rest_lag_sd_ms",
                      "rest_speed_mm_per_s", "hold_s", "samples_per_rest", "sine_rate_hz"});
  ReadPositive(section, "cutoff_hz", options.smoothing.cutoff_hz);
  if (const auto order = section.Find("filter_order")) {
    options.smoothing.filter_order = static_cast<int>(order->Integer(1, 10));
  }
  if (const auto gap = section.Find("longest_gap_s")) {
    gap->Expect(gap->Number() >= 0.0, "a number of at least 0");
    options.smoothing.longest_fill_s = gap->Number();
  }
  if (const auto lag = section.Find("expected_lag_s")) options.expected_lag_s = lag->Number();
  if (const auto lag = section.Find("longest_lag_s")) {
    lag->Expect(lag->Number() > 0.0 && lag->Number() <= 3600.0, "a number above 0, at most 3600");
    options.clock.longest_lag_s = lag->Number();
  }
  ReadPositive(section, "largest_lag_sd_ms", options.clock.largest_sd_s, 1e-3);
  ReadPositive(section, "largest_rest_lag_sd_ms", options.largest_rest_lag_sd_s, 1e-3);
  ReadPositive(section, "rest_speed_mm_per_s", options.rest.threshold_m_per_s, kMetresPerMm);
  ReadPositive(section, "hold_s", options.rest.hold_s);
  if (const auto samples = section.Find("samples_per_rest")) {
    options.rest.samples_per_run = static_cast<int>(samples->Integer(1, 100000));
  }
  ReadPositive(section, "sine_rate_hz", options.sine_rate_hz);
}

}  // namespace elastocal
