// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/simulation_settings.hpp"

#include <set>

#include <gtest/gtest.h>

#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"

namespace elastocal {
namespace {

TEST(SimulationSettings, FileSetsWhatItNamesInItsUnits) {
  const ScratchFolder scratch;
  VirtualExperimentOptions options;
  ReadSimulationSettings(scratch.Write("settings.yaml",
                                       "marker_noise_mm: 0.5\n"
                                       "leg_offset_deg: 90e-2\n"
                                       "encoder_bits: 14\n"
                                       "lag_s: 4\n"
                                       "knocked_cluster: LHAND\n"
                                       "pelvis_compliance: [1e-7, 0, 3e-7, 4e-6, 5e-6, 6e-6]\n"),
                         options);
  EXPECT_DOUBLE_EQ(options.sensors.marker_noise_sd, 0.5e-3);
  EXPECT_DOUBLE_EQ(options.truth.leg_offset_sd, 0.9 * M_PI / 180.0);
  EXPECT_EQ(options.sensors.encoder_bits, 14);
  EXPECT_EQ(options.faults.lag_s, 4.0);
  EXPECT_EQ(options.faults.knocked_cluster, "LHAND");
  EXPECT_EQ(options.truth.pelvis_compliance[5], 6e-6);
  EXPECT_EQ(options.truth.length_sd, TruthOptions{}.length_sd);
}

TEST(SimulationSettings, RefusesWhatItDoesNotKnow) {
  const ScratchFolder scratch;
  const auto refused = [&](const std::string& text, std::initializer_list<std::string> parts) {
    VirtualExperimentOptions options;
    const std::string file = scratch.Write("settings.yaml", text);
    ExpectInputError([&] { ReadSimulationSettings(file, options); }, parts);
  };
  refused("marker_noise: 1\n", {"settings.yaml", "marker_noise", "did you mean"});
  refused("marker_noise_mm: big\n", {"settings.yaml:1", "marker_noise_mm", "'big'"});
  refused("\nmarker_noise_mm: -1\n", {"settings.yaml:2", "from 0"});
  refused("encoder_bits: 12.5\n", {"encoder_bits", "whole number"});
  refused("pelvis_compliance: [1, 1]\n", {"pelvis_compliance", "2 numbers"});
}

TEST(SimulationSettings, RangesBeginWithTheSmallerNumber) {
  VirtualExperimentOptions options;
  CheckRanges(options);
  options.sensors.least_lag_s = options.sensors.largest_lag_s + 1.0;
  ExpectInputError([&] { CheckRanges(options); }, {"least_lag_s", "largest_lag_s"});
}

TEST(SimulationSettings, EachIsGivenOnceAndShowsItsDefault) {
  VirtualExperimentOptions options;
  std::set<std::string> keys;
  for (const SimulationSetting& setting : SimulationSettings(options)) {
    EXPECT_TRUE(keys.insert(setting.key).second) << setting.key;
    EXPECT_FALSE(setting.help.empty()) << setting.key;
    // A setting accepts the text that shows it.
    const std::string shown = SettingText(setting);
    if (!shown.empty()) ApplySetting(setting, shown, "");
    EXPECT_EQ(SettingText(setting), shown) << setting.key;
  }
  EXPECT_GT(keys.size(), 50u);
}

}  // namespace
}  // namespace elastocal
