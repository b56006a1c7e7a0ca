// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/marker_rows.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <Eigen/Geometry>

#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

constexpr double kAxisLength = 0.1;  // m
constexpr int kBodyPoints = 4;
constexpr std::size_t kBlock = 3 << 12;  // numbers, 96 KiB
constexpr int kPointNumbers = 3 * kBodyPoints;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

std::vector<std::string> PointNames(const std::string& body) {
  std::vector<std::string> points;
  for (int i = 1; i <= kBodyPoints; ++i) points.push_back(body + "_" + std::to_string(i));
  return points;
}

/// The points of a body; NaN where it was not seen.
Eigen::Matrix<double, 1, kPointNumbers> Points(const Eigen::Vector3d& origin,
                                               const Eigen::Vector4d& q) {
  Eigen::Matrix<double, 1, kPointNumbers> points;
  const double length = q.norm();
  if (!origin.allFinite() || !(length > 1e-6) || !std::isfinite(length)) {
    points.setConstant(kNaN);
    return points;
  }
  const Eigen::Matrix3d axes =
      kAxisLength * Eigen::Quaterniond(Eigen::Vector4d(q / length)).toRotationMatrix();
  points << origin.transpose(), (origin + axes.col(0)).transpose(),
      (origin + axes.col(1)).transpose(), (origin + axes.col(2)).transpose();
  return points;
}

}  // namespace

void MarkerRows::Add(double x, double y, double z) {
  const bool seen = std::isfinite(x) && std::isfinite(y) && std::isfinite(z) &&
                    (x != 0.0 || y != 0.0 || z != 0.0);
  if (seen) {
    Append(x, y, z);
  } else {
    AddGap();
  }
}

void MarkerRows::AddGap() { Append(kNaN, kNaN, kNaN); }

void MarkerRows::RemoveLast(std::size_t markers) {
  for (std::size_t count = 3 * markers; count > 0;) {
    std::vector<double>& block = blocks_.back();
    const std::size_t here = std::min(count, block.size());
    block.resize(block.size() - here);
    count -= here;
    if (block.empty()) blocks_.pop_back();
  }
}

void MarkerRows::Append(double x, double y, double z) {
  if (blocks_.empty() || blocks_.back().size() == kBlock) blocks_.emplace_back().reserve(kBlock);
  std::vector<double>& block = blocks_.back();
  block.push_back(x);
  block.push_back(y);
  block.push_back(z);
}

MarkerTrajectories MarkerRows::Take(std::string source, std::vector<std::string> names,
                                    double rate_hz) {
  MarkerTrajectories markers;
  markers.source = std::move(source);
  markers.rate_hz = rate_hz;
  const std::size_t columns = 3 * names.size();
  std::size_t count = 0;
  for (const std::vector<double>& block : blocks_) count += block.size();
  const std::size_t rows = columns == 0 ? 0 : count / columns;
  markers.positions.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
  // The rows of one block at a time stay in the cache while they become columns.
  std::vector<double> read;
  Eigen::Index row = 0;
  for (std::vector<double>& block : blocks_) {
    read.insert(read.end(), block.begin(), block.end());
    block = std::vector<double>();
    const std::size_t whole = columns == 0 ? 0 : read.size() / columns;
    if (whole == 0) continue;
    const Eigen::Map<const RowMajor> frames(read.data(), static_cast<Eigen::Index>(whole),
                                            markers.positions.cols());
    markers.positions.middleRows(row, frames.rows()) = frames;
    row += frames.rows();
    read.erase(read.begin(), read.begin() + static_cast<std::ptrdiff_t>(whole * columns));
  }
  markers.names = std::move(names);
  blocks_.clear();
  return markers;
}

std::vector<std::string> DistinctNames(const std::vector<std::string>& names) {
  std::set<std::string> used(names.begin(), names.end()), given;
  std::map<std::string, int> count;
  std::vector<std::string> distinct;
  for (const std::string& name : names) {
    int& number = count[name];
    std::string unique = name;
    while (++number > 1) {
      unique = name + "#" + std::to_string(number);
      if (!used.contains(unique) && !given.contains(unique)) break;
    }
    given.insert(unique);
    distinct.push_back(unique);
  }
  return distinct;
}

void AddBodies(const BodyPoses& bodies, MarkerTrajectories& markers,
               std::vector<std::string>& notes) {
  const std::set<std::string> known(markers.names.begin(), markers.names.end());
  std::vector<Eigen::Index> kept;
  const Eigen::Index first = 3 * static_cast<Eigen::Index>(markers.names.size());
  for (std::size_t b = 0; b < bodies.names.size(); ++b) {
    const std::vector<std::string> points = PointNames(bodies.names[b]);
    if (std::any_of(points.begin(), points.end(),
                    [&](const std::string& name) { return known.contains(name); })) {
      notes.push_back("the rigid body " + bodies.names[b] +
                      " is left out: its markers have the names of its points");
      continue;
    }
    kept.push_back(static_cast<Eigen::Index>(b));
    markers.names.insert(markers.names.end(), points.begin(), points.end());
  }
  const Eigen::Index frames = bodies.positions.rows();
  const auto added = static_cast<Eigen::Index>(kept.size());
  markers.positions.conservativeResize(frames, first + kPointNumbers * added);
  for (Eigen::Index k = 0; k < added; ++k) {
    for (Eigen::Index frame = 0; frame < frames; ++frame) {
      markers.positions.block<1, kPointNumbers>(frame, first + kPointNumbers * k) =
          Points(bodies.positions.block<1, 3>(frame, 3 * kept[k]).transpose(),
                 bodies.rotations.block<1, 4>(frame, 4 * kept[k]).transpose());
    }
  }
}

}  // namespace elastocal
