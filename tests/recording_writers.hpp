// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "elastocal/measurement/trial.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {

// Recordings in the formats of others, for tests: written byte by byte from their descriptions.

/// How a C3D file is written.
struct C3dStyle {
  int processor = 84;  ///< 84 Intel, 85 DEC, 86 MIPS
  bool real = true;
  double integer_scale = 0.1;  ///< mm
  int analog = 0;              ///< analogue numbers a frame
  std::string units = "mm", y_screen = "+Z";
  double metres = 1e-3;                  ///< in a unit
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
  /// `values`: type, dimensions and data.
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
    text += Number(1, "FRAMES", static_cast<int>(counted));  // parameters may stand above the group
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

/// Three cells in mm with three decimals, as WriteQtmTsv has them; empty for a gap.
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

/// Each marker with a column of quality in between.
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

/// Bytes of little-endian numbers and texts, one after the other.
class Bytes {
 public:
  Bytes& U(std::uint64_t number, std::size_t width) {
    for (std::size_t i = 0; i < width; ++i) text += static_cast<char>(number >> 8 * i & 0xFF);
    return *this;
  }
  Bytes& F64(double number) { return U(std::bit_cast<std::uint64_t>(number), 8); }
  /// With its length; as in MCAP.
  Bytes& Text(std::string_view value) {
    U(value.size(), 4).text += value;
    return *this;
  }
  Bytes& Align(std::size_t width) {  // of CDR, behind its four bytes of head
    while ((text.size() - 4) % width != 0) text += '\0';
    return *this;
  }
  Bytes& CdrText(std::string_view value) {
    Align(4).U(value.size() + 1, 4).text += std::string(value) + '\0';
    return *this;
  }
  Bytes& CdrNumbers(const Eigen::VectorXd& numbers) {
    Align(4).U(static_cast<std::uint64_t>(numbers.size()), 4);
    for (const double number : numbers) Align(8).F64(number);
    return *this;
  }

  std::string text;
};

inline std::string JointStateCdr(const JointLog& log, int sample) {
  const auto ns = static_cast<std::int64_t>(std::llround(1e9 * log.time_s[sample]));
  Bytes bytes;
  bytes.text = std::string("\0\1\0\0", 4);
  bytes.U(static_cast<std::uint64_t>(ns / 1000000000), 4);
  bytes.U(static_cast<std::uint64_t>(ns % 1000000000), 4).CdrText("base");
  bytes.Align(4).U(log.names.size(), 4);
  for (const std::string& name : log.names) bytes.CdrText(name);
  bytes.CdrNumbers(log.positions.row(sample)).CdrNumbers({}).CdrNumbers(log.torques.row(sample));
  return bytes.text;
}

/// The body whose first point is marker 4 `body`.
inline std::string BodyOf(const MarkerTrajectories& markers, int body) {
  const std::string& name = markers.names[4 * static_cast<std::size_t>(body)];
  return name.substr(0, name.size() - 2);  // without "_1"
}

/// Poses of bodies whose points are the markers, four each (RecordingFile::markers), stamped by the
/// clock of a log that begins at `start_s`, or transforms (tf) in frame world; `add` gets (channel,
/// message).
template <typename AddMessage>
void AddPoses(const MarkerTrajectories& markers, double start_s, bool as_transforms,
              const AddMessage& add) {
  for (int frame = 0; frame < markers.frame_count(); ++frame) {
    const auto ns = static_cast<std::int64_t>(std::llround(1e9 * (frame / markers.rate_hz)) +
                                              std::llround(1e9 * start_s));
    for (int body = 0; body < markers.marker_count() / 4; ++body) {
      const auto point = [&](int i) -> Eigen::Vector3d {
        return markers.positions.row(frame).segment<3>(3 * (4 * body + i)).transpose();
      };
      if (std::isnan(point(0).x())) continue;
      Eigen::Matrix3d axes;
      for (int i = 0; i < 3; ++i) axes.col(i) = (point(i + 1) - point(0)).normalized();
      const Eigen::Quaterniond q(axes);
      Bytes bytes;
      bytes.text = std::string("\0\1\0\0", 4);
      if (as_transforms) bytes.U(1, 4);  // one in the message
      bytes.U(static_cast<std::uint64_t>(ns / 1000000000), 4);
      bytes.U(static_cast<std::uint64_t>(ns % 1000000000), 4).CdrText("world");
      if (as_transforms) bytes.CdrText(BodyOf(markers, body));
      bytes.Align(8);
      for (const double number : {point(0).x(), point(0).y(), point(0).z()}) bytes.F64(number);
      for (const double number : {q.x(), q.y(), q.z(), q.w()}) bytes.F64(number);
      add(as_transforms ? 1 : 1 + body, bytes.text);
    }
  }
}

/// A bag of joint states, and of poses of bodies where they are given (or of tf), without chunks.
inline std::string McapBytes(const JointLog& log, const MarkerTrajectories* bodies = nullptr,
                             double bodies_start_s = 0.0, bool as_transforms = false) {
  const std::string magic("\x89MCAP0\r\n", 8);
  std::string file = magic;
  const auto add = [&](int kind, const Bytes& record) {
    file += static_cast<char>(kind);
    file += Bytes().U(record.text.size(), 8).text + record.text;
  };
  add(1, Bytes().Text("ros2").Text("test"));
  add(3, Bytes().U(1, 2).Text("sensor_msgs/msg/JointState").Text("ros2msg").Text(""));
  add(4, Bytes().U(0, 2).U(1, 2).Text("/joint_states").Text("cdr").U(0, 4));
  for (int i = 0; i < log.sample_count(); ++i) {
    Bytes message;
    message.U(0, 2).U(static_cast<std::uint64_t>(i), 4).U(7, 8).U(7, 8);
    message.text += JointStateCdr(log, i);
    add(5, message);
  }
  if (bodies) {
    const char* const type =
        as_transforms ? "tf2_msgs/msg/TFMessage" : "geometry_msgs/msg/PoseStamped";
    add(3, Bytes().U(2, 2).Text(type).Text("ros2msg").Text(""));
    const int topics = as_transforms ? 1 : bodies->marker_count() / 4;
    for (int i = 0; i < topics; ++i) {
      Bytes channel;
      channel.U(1 + static_cast<std::uint64_t>(i), 2).U(2, 2);
      channel.Text(as_transforms ? "/tf" : "/mocap/" + BodyOf(*bodies, i) + "/pose");
      add(4, channel.Text("cdr").U(0, 4));
    }
    AddPoses(*bodies, bodies_start_s, as_transforms, [&](int channel, const std::string& text) {
      Bytes message;
      message.U(static_cast<std::uint64_t>(channel), 2).U(0, 4).U(7, 8).U(7, 8);
      message.text += text;
      add(5, message);
    });
  }
  add(15, Bytes().U(0, 4));
  add(2, Bytes().U(0, 8).U(0, 8).U(0, 4));
  return file + magic;
}

inline std::uint32_t Crc32(std::string_view bytes) {
  std::uint32_t crc = ~0u;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int i = 0; i < 8; ++i) crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0u);
  }
  return ~crc;
}

/// Columns of numbers as a .npz that is not compressed.
inline std::string NpzBytes(const std::vector<std::pair<std::string, Eigen::VectorXd>>& columns) {
  std::string file, directory;
  for (const auto& [name, column] : columns) {
    std::string head = "{'descr': '<f8', 'fortran_order': False, 'shape': (" +
                       std::to_string(column.size()) + ",), }";
    head.resize((head.size() + 10 + 64) / 64 * 64 - 11, ' ');
    Bytes array;
    array.text = std::string("\x93NUMPY\1\0", 8);
    array.U(head.size() + 1, 2).text += head + '\n';
    for (const double number : column) array.F64(number);
    const std::string entry = name + ".npy";
    Bytes fields;
    fields.U(20, 2).U(0, 2).U(0, 2).U(0, 2).U(0x21, 2).U(Crc32(array.text), 4);
    fields.U(array.text.size(), 4).U(array.text.size(), 4).U(entry.size(), 2).U(0, 2);
    Bytes listed;
    listed.text = "PK\1\2";
    listed.U(20, 2).text += fields.text;
    listed.U(0, 2).U(0, 2).U(0, 2).U(0, 4).U(file.size(), 4).text += entry;
    directory += listed.text;
    file += "PK\3\4" + fields.text + entry + array.text;
  }
  Bytes end;
  end.text = "PK\5\6";
  end.U(0, 4).U(columns.size(), 2).U(columns.size(), 2).U(directory.size(), 4);
  return file + directory + end.U(file.size(), 4).U(0, 2).text;
}

}  // namespace elastocal
