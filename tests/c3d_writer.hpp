// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "elastocal/measurement/trial.hpp"

namespace elastocal {

// Recordings in the formats of others, for tests: written byte by byte from their descriptions.

/// Options for writing a C3D file.
struct C3dStyle {
  int processor = 84;  ///< 84 Intel, 85 DEC, 86 MIPS
  bool real = true;
  double integer_scale = 0.1;  ///< mm
  int analog = 0;              ///< analogue numbers in each frame
  std::string units = "mm", y_screen = "+Z";
  double metres = 1e-3;                  ///< metres per unit
  std::size_t labels_a_list = 255;       ///< the rest goes into LABELS2
  std::vector<std::string> angles = {};  ///< labels that are in POINT:ANGLES as well
  std::string counted_by = "FRAMES";     ///< or "TRIAL", "LONG_FRAMES", "wrapped"
};

class C3dWriter {
 public:
  C3dWriter(const MarkerTrajectories& markers, const C3dStyle& style)
      : markers_(markers), style_(style) {}

  std::string Write() {
    const auto frames = static_cast<std::size_t>(markers_.frame_count());
    const std::string parameters = Parameters(frames);
    const std::size_t blocks = (parameters.size() + 511) / 512;
    std::string header(512, '\0');
    header[0] = 2;
    header[1] = 0x50;
    const auto put = [&](std::size_t word, const std::string& bytes) {
      header.replace(2 * (word - 1), bytes.size(), bytes);
    };
    put(2, Integer(markers_.marker_count()));
    put(3, Integer(style_.analog));
    put(4, Integer(1));
    put(5, Integer(static_cast<int>(std::min<std::size_t>(frames, 65535))));
    put(7, Real(style_.real ? -1.0f : static_cast<float>(style_.integer_scale)));
    put(9, Integer(static_cast<int>(2 + blocks)));
    put(11, Real(static_cast<float>(markers_.rate_hz)));
    std::string file = header + parameters;
    file.resize(512 * (1 + blocks));
    for (std::size_t frame = 0; frame < frames; ++frame) AddFrame(static_cast<int>(frame), file);
    file.resize((file.size() + 511) / 512 * 512);
    return file;
  }

 private:
  std::string Integer(int number) const {
    const char low = static_cast<char>(number & 0xFF), high = static_cast<char>(number >> 8 & 0xFF);
    return style_.processor == 86 ? std::string{high, low} : std::string{low, high};
  }

  std::string Real(float number) const {
    auto bits = std::bit_cast<std::uint32_t>(number);
    if (style_.processor == 85) {
      if (number != 0.0f) bits += 0x01000000u;
      return Integer(static_cast<int>(bits >> 16)) + Integer(static_cast<int>(bits & 0xFFFF));
    }
    const std::string high = Integer(static_cast<int>(bits >> 16));
    const std::string low = Integer(static_cast<int>(bits & 0xFFFF));
    return style_.processor == 86 ? high + low : low + high;
  }

  static std::string Byte(int number) { return std::string(1, static_cast<char>(number)); }

  std::string Group(int id, const std::string& name) const {
    return Byte(static_cast<int>(name.size())) + Byte(-id) + name + Integer(3) + Byte(0);
  }
  /// Writes a parameter, whose `values` are type, dimensions and data.
  std::string Parameter(int id, const std::string& name, const std::string& values) const {
    return Byte(static_cast<int>(name.size())) + Byte(id) + name +
           Integer(static_cast<int>(values.size()) + 3) + values + Byte(0);
  }
  std::string Text(int id, const std::string& name, const std::string& text) const {
    return Parameter(id, name, Byte(-1) + Byte(1) + Byte(static_cast<int>(text.size())) + text);
  }
  std::string Texts(int id, const std::string& name, std::vector<std::string> texts) const {
    std::size_t length = 1;
    for (const std::string& text : texts) length = std::max(length, text.size());
    std::string values =
        Byte(-1) + Byte(2) + Byte(static_cast<int>(length)) + Byte(static_cast<int>(texts.size()));
    for (std::string& text : texts) {
      text.resize(length, ' ');
      values += text;
    }
    return Parameter(id, name, values);
  }
  std::string Number(int id, const std::string& name, int number) const {
    return Parameter(id, name, Byte(2) + Byte(0) + Integer(number));
  }
  std::string RealNumber(int id, const std::string& name, float number) const {
    return Parameter(id, name, Byte(4) + Byte(0) + Real(number));
  }
  std::string Words(int id, const std::string& name, std::size_t number) const {
    return Parameter(id, name,
                     Byte(2) + Byte(1) + Byte(2) + Integer(static_cast<int>(number & 0xFFFF)) +
                         Integer(static_cast<int>(number >> 16)));
  }

  std::string Parameters(std::size_t frames) const {
    std::string text{'\1', '\x50', '\2', static_cast<char>(style_.processor)};
    const bool wrapped = style_.counted_by == "wrapped";
    const std::size_t counted = wrapped ? frames % 65536 : std::min<std::size_t>(frames, 65535);
    text += Number(1, "FRAMES", static_cast<int>(counted));  // parameters may precede their group
    text += Group(1, "POINT");
    text += Number(1, "USED", markers_.marker_count());
    text += RealNumber(1, "SCALE", style_.real ? -1.0f : static_cast<float>(style_.integer_scale));
    text += RealNumber(1, "RATE", static_cast<float>(markers_.rate_hz));
    if (!style_.units.empty()) text += Text(1, "UNITS", style_.units);
    if (!style_.y_screen.empty()) text += Text(1, "Y_SCREEN", style_.y_screen);
    for (std::size_t begin = 0, list = 1; begin < markers_.names.size();
         begin += style_.labels_a_list, ++list) {
      const auto from = markers_.names.begin() + static_cast<std::ptrdiff_t>(begin);
      const std::size_t count = std::min(style_.labels_a_list, markers_.names.size() - begin);
      text += Texts(1, list == 1 ? "LABELS" : "LABELS" + std::to_string(list),
                    {from, from + static_cast<std::ptrdiff_t>(count)});
    }
    if (!style_.angles.empty()) text += Texts(1, "ANGLES", style_.angles);
    if (style_.counted_by == "LONG_FRAMES") {
      text += RealNumber(1, "LONG_FRAMES", static_cast<float>(frames));
    }
    if (style_.counted_by == "TRIAL") {
      text += Group(2, "TRIAL") + Words(2, "ACTUAL_START_FIELD", 5) +
              Words(2, "ACTUAL_END_FIELD", frames + 4);
    }
    return text + std::string(2, '\0');
  }

  void AddFrame(int frame, std::string& file) const {
    for (int m = 0; m < markers_.marker_count(); ++m) {
      const bool seen = !std::isnan(markers_.positions(frame, 3 * m));
      for (int axis = 0; axis < 3; ++axis) {
        const double number = seen ? markers_.positions(frame, 3 * m + axis) / style_.metres : 0.0;
        file += style_.real ? Real(static_cast<float>(number))
                            : Integer(static_cast<int>(std::lround(number / style_.integer_scale)));
      }
      const int residual = seen ? 0x0305 : -1;  // two cameras, and a residual
      file += style_.real ? Real(static_cast<float>(residual)) : Integer(residual);
    }
    for (int i = 0; i < style_.analog; ++i) file += style_.real ? Real(1e9f) : Integer(-1);
  }

  const MarkerTrajectories& markers_;
  const C3dStyle& style_;
};

}  // namespace elastocal
