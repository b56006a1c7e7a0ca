// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "elastocal/measurement/trial.hpp"

namespace elastocal {

// Recordings in the formats of others, for tests: written byte by byte from their descriptions.

/// Bytes of little-endian numbers and texts, one after the other.
class Bytes {
 public:
  Bytes& U(std::uint64_t number, std::size_t width) {
    for (std::size_t i = 0; i < width; ++i) text += static_cast<char>(number >> 8 * i & 0xFF);
    return *this;
  }
  Bytes& F64(double number) { return U(std::bit_cast<std::uint64_t>(number), 8); }
  /// Appends a text after its length, as in MCAP.
  Bytes& Text(std::string_view value) {
    U(value.size(), 4).text += value;
    return *this;
  }
  Bytes& Align(std::size_t width) {  // alignment of CDR, after its head of four bytes
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

/// The body whose first point is the marker number 4 `body`.
inline std::string BodyOf(const MarkerTrajectories& markers, int body) {
  const std::string& name = markers.names[4 * static_cast<std::size_t>(body)];
  return name.substr(0, name.size() - 2);  // without "_1"
}

/// Adds poses of bodies, of which each four markers are the points (RecordingFile::markers), or
/// transforms (tf) in frame world. Their times are those of a log that begins at `start_s`. `add`
/// gets (channel, message).
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
      if (as_transforms) bytes.U(1, 4);  // one transform in the message
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

/// A bag without chunks, with joint states and, if given, poses of bodies (or tf).
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

/// Columns of numbers as an uncompressed .npz.
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
