// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"
#include "tests/biped.hpp"

namespace elastocal {

/// The biped with both legs elastic, and empty recordings for tests to fill in.
struct StandingBiped {
  Biped biped = MakeBiped();
  int left = FindLink(biped.tree, "left_sole"), right = FindLink(biped.tree, "right_sole");
  ErrorModel model =
      MakeErrorModel(biped.tree, biped.markers, {}, {.legs = {{"left", left}, {"right", right}}});

  /// A recording with `postures` postures for each trial and all markers at the origin.
  Recording Empty(std::vector<Trial> trials, int postures) const {
    Recording recording;
    recording.trials = std::move(trials);
    const auto rows = static_cast<Eigen::Index>(recording.trials.size()) * postures;
    recording.q.setZero(rows, biped.tree.coordinate_count());
    recording.markers.setZero(rows, 3 * model.marker_count());
    for (const Marker& marker : model.markers) recording.marker_names.push_back(marker.name);
    for (Eigen::Index i = 0; i < rows; ++i) {
      recording.trial.push_back(static_cast<int>(i) / postures);
    }
    return recording;
  }

  /// Hides all markers in a posture except those of the given clusters ("WAIST").
  void ShowOnly(const std::vector<std::string>& clusters, int posture, Recording& recording) const {
    for (int m = 0; m < model.marker_count(); ++m) {
      bool shown = false;
      for (const std::string& cluster : clusters) {
        shown = shown || model.markers[m].name.starts_with(cluster + "_");
      }
      if (shown) continue;
      recording.markers.block<1, 3>(posture, 3 * m)
          .setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  }
};

}  // namespace elastocal
