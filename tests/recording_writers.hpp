// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>

#include "elastocal/measurement/trial.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {

// Recordings in the formats of others, for tests: written byte by byte from their descriptions.

/// Three cells in mm with three decimals, as by WriteQtmTsv. They are empty for a gap.
inline std::string TextCells(const MarkerTrajectories& markers, int frame, int marker, char by) {
  std::string cells;
  for (int axis = 0; axis < 3; ++axis) {
    const double position = markers.positions(frame, 3 * marker + axis);
    if (axis > 0) cells += by;
    if (!std::isnan(position)) AppendFixed(1e3 * position, 3, cells);
  }
  return cells;
}

inline std::string ViconText(const MarkerTrajectories& markers) {
  std::string text = "Devices\n1000\n,,Plate\nFrame,Sub Frame,Fx\n,,N\n1,0,5\n\nTrajectories\n";
  text += FormatNumber(markers.rate_hz) + "\n,";
  for (const std::string& name : markers.names) text += ",talos:" + name + ",,";
  text += "\nFrame,Sub Frame";
  for (int m = 0; m < markers.marker_count(); ++m) text += ",X,Y,Z";
  text += "\n,";
  for (int m = 0; m < markers.marker_count(); ++m) text += ",mm,mm,mm";
  text += "\n";
  for (int frame = 0; frame < markers.frame_count(); ++frame) {
    text += std::to_string(101 + frame) + ",0";
    for (int m = 0; m < markers.marker_count(); ++m) {
      text += "," + TextCells(markers, frame, m, ',');
    }
    text += "\n";
  }
  return text;
}

inline std::string TrcText(const MarkerTrajectories& markers) {
  const std::string rate = FormatNumber(markers.rate_hz);
  std::string text = "PathFileType\t4\t(X/Y/Z)\tplayed.trc\n";
  text += "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n";
  text += rate + "\t" + rate + "\t" + std::to_string(markers.frame_count()) + "\t" +
          std::to_string(markers.marker_count()) + "\tmm\nFrame#\tTime";
  for (const std::string& name : markers.names) text += "\t" + name + "\t\t";
  text += "\n\t";
  for (int m = 1; m <= markers.marker_count(); ++m) {
    for (const char axis : {'X', 'Y', 'Z'}) text += std::string("\t") + axis + std::to_string(m);
  }
  text += "\n\n";
  for (int frame = 0; frame < markers.frame_count(); ++frame) {
    text += std::to_string(1 + frame) + "\t";
    AppendFixed(frame / markers.rate_hz, 5, text);
    for (int m = 0; m < markers.marker_count(); ++m) {
      text += "\t" + TextCells(markers, frame, m, '\t');
    }
    text += "\n";
  }
  return text;
}

/// Writes a take in which each marker is followed by a column of its quality.
inline std::string MotiveText(const MarkerTrajectories& markers) {
  const std::string rate = FormatNumber(markers.rate_hz);
  std::string text =
      "Format Version,1.23,Take Name,played,Capture Frame Rate," + rate + ",Export Frame Rate," +
      rate + ",Total Exported Frames," + std::to_string(markers.frame_count()) +
      ",Rotation Type,Quaternion,Length Units,Millimeters,Coordinate Space,Global\n\n";
  const auto row = [&](const std::string& begin, const auto& cells) {
    text += begin;
    for (const std::string& name : markers.names) text += "," + cells(name);
    text += "\n";
  };
  const auto four = [](const std::string& cell) {
    return cell + "," + cell + "," + cell + "," + cell;
  };
  row(",Type", [&](const std::string&) { return four("Marker"); });
  row(",Name", four);
  row(",ID", [&](const std::string&) { return four("1"); });
  row(",",
      [](const std::string&) { return std::string("Position,Position,Position,Marker Quality"); });
  row("Frame,Time (Seconds)", [](const std::string&) { return std::string("X,Y,Z,"); });
  for (int frame = 0; frame < markers.frame_count(); ++frame) {
    text += std::to_string(frame) + ",";
    AppendFixed(frame / markers.rate_hz, 6, text);
    for (int m = 0; m < markers.marker_count(); ++m) {
      text += "," + TextCells(markers, frame, m, ',') + ",1.000";
    }
    text += "\n";
  }
  return text;
}

}  // namespace elastocal
