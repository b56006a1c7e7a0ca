// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/curves_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace elastocal {
namespace {

constexpr double kWidth = 640.0, kPanelHeight = 300.0;
constexpr double kLeft = 64.0, kRight = 130.0, kTop = 34.0, kBottom = 46.0;
constexpr std::array kColours = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"};

std::string Escaped(const std::string& text) {
  std::string escaped;
  for (char c : text) {
    switch (c) {
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '&':
        escaped += "&amp;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

/// A round step that divides a range into about five parts.
double RoundStep(double range) {
  const double raw = range / 5.0;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw) return factor * power;
  }
  return 10.0 * power;
}

struct Axis {
  double lower = std::numeric_limits<double>::infinity();
  double upper = -std::numeric_limits<double>::infinity();
  double from = 0.0, to = 1.0;  // range in the picture

  void Include(const std::vector<double>& values) {
    for (double value : values) {
      lower = std::min(lower, value);
      upper = std::max(upper, value);
    }
  }
  void Round() {
    if (!(upper > lower)) upper = lower + 1.0;
    const double step = RoundStep(upper - lower);
    lower = step * std::floor(lower / step);
    upper = step * std::ceil(upper / step);
  }
  double At(double value) const { return from + (to - from) * (value - lower) / (upper - lower); }
};

class Panel {
 public:
  Panel(const std::string& name, double top, const std::string& x_label, const std::string& y_label)
      : name_(name), top_(top), x_label_(x_label), y_label_(y_label) {}

  std::string Draw(const std::vector<Curve>& curves) {
    for (const Curve& curve : curves) {
      if (curve.panel != name_) continue;
      x_.Include(curve.x);
      y_.Include(curve.y);
    }
    x_.Round();
    y_.Round();
    x_.from = kLeft;
    x_.to = kWidth - kRight;
    y_.from = top_ + kPanelHeight - kBottom;
    y_.to = top_ + kTop;
    std::string svg = Frame();
    int index = 0;
    for (const Curve& curve : curves) {
      if (curve.panel == name_) svg += Line(curve, index++);
    }
    return svg;
  }

 private:
  std::string Frame() const {
    std::string svg = fmt::format("<text x=\"{}\" y=\"{}\" font-weight=\"bold\">{}</text>\n", kLeft,
                                  top_ + 20.0, Escaped(name_));
    double x = x_.lower;
    while (x <= x_.upper * (1.0 + 1e-9)) {
      svg += fmt::format(
          "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\" stroke=\"#ddd\"/>"
          "<text x=\"{0:.1f}\" y=\"{3:.1f}\" text-anchor=\"middle\">{4:g}</text>\n",
          x_.At(x), y_.from, y_.to, y_.from + 16.0, x);
      x += RoundStep(x_.upper - x_.lower);
    }
    const double step = RoundStep(y_.upper - y_.lower);
    for (int i = 0; y_.lower + i * step <= y_.upper + 1e-9 * step; ++i) {
      const double y = y_.lower + i * step;
      svg += fmt::format(
          "<line x1=\"{0:.1f}\" x2=\"{1:.1f}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" stroke=\"#ddd\"/>"
          "<text x=\"{3:.1f}\" y=\"{4:.1f}\" text-anchor=\"end\">{5:.4g}</text>\n",
          x_.from, x_.to, y_.At(y), x_.from - 6.0, y_.At(y) + 4.0, y);
    }
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                       0.5 * (x_.from + x_.to), y_.from + 36.0, Escaped(x_label_));
    svg += fmt::format(
        "<text transform=\"translate(16,{:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
        0.5 * (y_.from + y_.to), Escaped(y_label_));
    return svg;
  }

  std::string Line(const Curve& curve, int index) const {
    const char* colour = kColours[static_cast<std::size_t>(index) % kColours.size()];
    std::string points, dots;
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      const double x = x_.At(curve.x[i]);
      const double y = y_.At(curve.y[i]);
      points += fmt::format("{:.1f},{:.1f} ", x, y);
      dots += fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="3" fill="{}"/>)", x, y, colour);
    }
    const double y = y_.to + 8.0 + 18.0 * index;
    return fmt::format(
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>{}\n"
        "<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" "
        "stroke-width=\"2\"/><text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
        points, colour, dots, x_.to + 10.0, x_.to + 28.0, y, y, colour, x_.to + 34.0, y + 4.0,
        Escaped(curve.name));
  }

  std::string name_;
  double top_;
  std::string x_label_, y_label_;
  Axis x_, y_;
};

}  // namespace

std::string FormatCurvesSvg(const std::vector<Curve>& curves, const std::string& x_label,
                            const std::string& y_label) {
  std::vector<std::string> panels;
  for (const Curve& curve : curves) {
    if (curve.x.empty()) continue;
    if (std::find(panels.begin(), panels.end(), curve.panel) == panels.end()) {
      panels.push_back(curve.panel);
    }
  }
  const double height = kPanelHeight * static_cast<double>(panels.size());
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
      "height=\"{1}\" font-family=\"sans-serif\" font-size=\"12\">\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
      kWidth, height);
  double top = 0.0;
  for (const std::string& panel : panels) {
    svg += Panel(panel, top, x_label, y_label).Draw(curves);
    top += kPanelHeight;
  }
  return svg + "</svg>\n";
}

}  // namespace elastocal
