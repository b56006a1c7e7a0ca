#include "elastocal/io/waist_truth.hpp"

#include <array>
#include <cmath>
#include <fstream>

#include "elastocal/io/output_files.hpp"
#include "elastocal/io/posture_checks.hpp"
#include "elastocal/io/table_lines.hpp"
#include "elastocal/io/text.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

constexpr std::array kWaistColumns = {"t", "x", "y", "z", "qw", "qx", "qy", "qz"};

}  // namespace

WaistTruth ReadWaistTruth(const fs::path& file) {
  std::ifstream stream = OpenTable(file);
  TableLines lines(stream, file.string());
  std::vector<std::string> cells;
  const std::vector<std::string> expected(kWaistColumns.begin(), kWaistColumns.end());
  if (!lines.Next(cells) || cells != expected) {
    throw InputError(file.string() + ": the header t,x,y,z,qw,qx,qy,qz was expected");
  }
  WaistTruth truth;
  std::vector<double> time_s;
  while (lines.Next(cells)) {
    if (cells.size() != expected.size()) {
      throw InputError(Place(file.string(), lines.line()) + "found " +
                       std::to_string(cells.size()) + " cells; 8 were expected");
    }
    std::array<double, kWaistColumns.size()> row{};
    for (std::size_t c = 0; c < row.size(); ++c) {
      row[c] = CellNumber(cells[c], expected[c], file.string(), lines.line());
    }
    const Eigen::Quaterniond q(row[4], row[5], row[6], row[7]);
    if (!(std::abs(q.norm() - 1.0) < 1e-6)) {
      throw InputError(Place(file.string(), lines.line()) +
                       "columns 'qw' to 'qz': a quaternion of unit length was expected");
    }
    Transform T = Transform::Identity();
    T.linear() = q.normalized().toRotationMatrix();
    T.translation() = Eigen::Vector3d(row[1], row[2], row[3]);
    truth.T_camera_waist.push_back(T);
    time_s.push_back(row[0]);
  }
  truth.time_s =
      Eigen::Map<const Eigen::VectorXd>(time_s.data(), static_cast<Eigen::Index>(time_s.size()));
  return truth;
}

void WriteWaistTruth(const fs::path& file, const WaistTruth& truth) {
  std::string text;
  for (const char* column : kWaistColumns) text += (text.empty() ? "" : ",") + std::string(column);
  text += '\n';
  for (std::size_t i = 0; i < truth.T_camera_waist.size(); ++i) {
    const Transform& T = truth.T_camera_waist[i];
    const Eigen::Quaterniond q(T.linear());
    text += FormatNumber(truth.time_s[static_cast<Eigen::Index>(i)]);
    for (double value : {T.translation().x(), T.translation().y(), T.translation().z(), q.w(),
                         q.x(), q.y(), q.z()}) {
      text += "," + FormatNumber(value);
    }
    text += '\n';
  }
  WriteFile(file, text);
}

}  // namespace elastocal
