// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace elastocal {

/// A line of a diagram.
struct Curve {
  std::string name, panel;  ///< curves of one panel share its axes
  std::vector<double> x, y;
};

/// Curves as an SVG picture, one panel under the other, with axes, legend and colours that
/// colour-blind readers can tell apart (Okabe and Ito). Names are escaped.
std::string FormatCurvesSvg(const std::vector<Curve>& curves, const std::string& x_label,
                            const std::string& y_label);

}  // namespace elastocal
