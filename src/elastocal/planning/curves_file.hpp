// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace elastocal {

/// A line in a diagram.
struct Curve {
  std::string name, panel;  ///< curves of one panel share its axes
  std::vector<double> x, y;
};

/// Draws curves as an SVG picture: one panel below the other, with axes, legend and colours that
/// colour-blind readers can distinguish (Okabe and Ito). Names are escaped.
std::string FormatCurvesSvg(const std::vector<Curve>& curves, const std::string& x_label,
                            const std::string& y_label);

}  // namespace elastocal
