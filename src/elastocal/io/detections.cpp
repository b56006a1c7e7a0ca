// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/detections.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "elastocal/io/known_names.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/table_reader.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr std::array<const char*, 6> kDetectionColumns = {"frame", "tag", "corner",
                                                          "u",     "v",   "camera"};
enum DetectionColumn { kFrameColumn, kTagColumn, kCornerColumn, kUColumn, kVColumn, kCameraColumn };
constexpr double kMostPixels = 1e5;

std::vector<int> FindDetectionColumns(const Table& table, bool several_cameras) {
  ColumnRoles roles;
  for (int i = 0; i < static_cast<int>(kDetectionColumns.size()); ++i) {
    roles.emplace(kDetectionColumns[static_cast<std::size_t>(i)], i);
  }
  const std::vector<int> columns = FindColumns(table, roles, kDetectionColumns.size(),
                                               "a table of corners has frame, tag, corner, u, v");
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i] >= 0 || (i == kCameraColumn && !several_cameras)) continue;
    table.Fail("the column " + Quote(kDetectionColumns[i]) + " is missing");
  }
  return columns;
}

/// Index of the item of `known` that a cell names.
std::string NameIn(const Table& table, int column, const char* what,
                   const std::set<std::string>& known) {
  const std::string name(table.Cell(column));
  if (!known.contains(name)) {
    table.FailCell(column,
                   std::string("there is no ") + what + " " + Quote(name) + Known(name, known));
  }
  return name;
}

int CornerOf(const Table& table, int column) {
  const double corner = table.Number(column);
  if (corner != 0.0 && corner != 1.0 && corner != 2.0 && corner != 3.0) {
    table.FailCell(column, "a corner is 0, 1, 2 or 3");
  }
  return static_cast<int>(corner);
}

double PixelIn(const Table& table, int column) {
  const double pixel = table.Number(column);
  if (!(std::abs(pixel) <= kMostPixels)) {
    table.FailCell(column, "a pixel of an image was expected, within 100000");
  }
  return pixel;
}

}  // namespace

bool IsDetectionTable(const std::filesystem::path& file) {
  std::istringstream stream = OpenTable(file);
  const Table table(stream, file.string());
  const std::vector<std::string>& header = table.header();
  const auto has = [&](const char* column) {
    return std::find(header.begin(), header.end(), column) != header.end();
  };
  return has("tag") && has("corner");
}

std::vector<Detection> ReadDetections(const std::filesystem::path& file, const Project& project) {
  std::set<std::string> cameras;
  std::set<std::string> tags;
  std::map<std::pair<std::string, std::string>, int> instruments;
  for (const TagInCamera& seen : project.contact->seen_tags) {
    cameras.insert(seen.camera);
    tags.insert(seen.tag);
    instruments[{seen.camera, seen.tag}] = seen.instrument;
  }
  std::istringstream stream = OpenTable(file);
  Table table(stream, file.string());
  if (cameras.empty()) {
    throw InputError(file.string() + ": this is a table of corners, and " + project.file.string() +
                     " has no instruments.cameras and tags");
  }
  const std::vector<int> columns = FindDetectionColumns(table, cameras.size() > 1);
  std::vector<Detection> detections;
  std::map<std::pair<std::string, int>, std::size_t> known;  // by frame and instrument
  while (table.Next()) {
    const std::string frame(table.Cell(columns[kFrameColumn]));
    const std::string tag = NameIn(table, columns[kTagColumn], "tag", tags);
    const std::string camera = cameras.size() > 1
                                   ? NameIn(table, columns[kCameraColumn], "camera", cameras)
                                   : *cameras.begin();
    const int instrument = instruments.at({camera, tag});
    const auto [at, is_new] = known.emplace(std::pair(frame, instrument), detections.size());
    if (is_new) {
      detections.push_back({frame, instrument,
                            Eigen::VectorXd::Constant(8, std::numeric_limits<double>::quiet_NaN()),
                            table.line()});
    }
    Detection& detection = detections[at->second];
    const int corner = CornerOf(table, columns[kCornerColumn]);
    if (!std::isnan(detection.pixels[2 * corner])) {
      table.FailCell(columns[kCornerColumn], "the corner comes twice in this frame");
    }
    detection.pixels[2 * corner] = PixelIn(table, columns[kUColumn]);
    detection.pixels[2 * corner + 1] = PixelIn(table, columns[kVColumn]);
  }
  const auto is_share = [](const Detection& of) {
    return of.pixels.minCoeff() >= 0.0 && of.pixels.maxCoeff() <= 1.0;
  };
  for (const Detection& detection : detections) {
    if (!detection.pixels.hasNaN()) continue;
    throw InputError(Place(file.string(), detection.line) + "the tag has not all of its four " +
                     "corners in this frame; all or none were expected");
  }
  if (!detections.empty() && std::all_of(detections.begin(), detections.end(), is_share)) {
    table.Fail("u and v are from 0 to 1 in all rows, shares of the image; pixels were expected");
  }
  return detections;
}

}  // namespace elastocal
