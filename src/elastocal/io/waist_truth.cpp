// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/waist_truth.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "elastocal/files/output_files.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/table_reader.hpp"
#include "elastocal/tables/table_writer.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

constexpr std::array kWaistColumns = {"t", "x", "y", "z", "qw", "qx", "qy", "qz"};

}  // namespace

WaistTruth ReadWaistTruth(const fs::path& file) {
  std::istringstream stream = OpenTable(file);
  Table table(stream, file.string());
  if (!std::equal(kWaistColumns.begin(), kWaistColumns.end(), table.header().begin(),
                  table.header().end())) {
    throw InputError(file.string() + ": the header t,x,y,z,qw,qx,qy,qz was expected");
  }
  WaistTruth truth;
  std::vector<double> time_s;
  while (table.Next()) {
    const auto number = [&](int column) { return table.Number(column); };
    const Eigen::Quaterniond q(number(4), number(5), number(6), number(7));
    if (!(std::abs(q.norm() - 1.0) < 1e-6)) {
      table.Fail("columns 'qw' to 'qz': a quaternion of unit length was expected");
    }
    Transform T = Transform::Identity();
    T.linear() = q.normalized().toRotationMatrix();
    T.translation() = Eigen::Vector3d(number(1), number(2), number(3));
    truth.T_camera_waist.push_back(T);
    time_s.push_back(number(0));
  }
  truth.time_s =
      Eigen::Map<const Eigen::VectorXd>(time_s.data(), static_cast<Eigen::Index>(time_s.size()));
  return truth;
}

void WriteWaistTruth(const fs::path& file, const WaistTruth& truth) {
  TableWriter table;
  for (const char* column : kWaistColumns) table.Add(column);
  table.EndRow();
  for (std::size_t i = 0; i < truth.T_camera_waist.size(); ++i) {
    const Transform& T = truth.T_camera_waist[i];
    const Eigen::Quaterniond q(T.linear());
    table.Add(truth.time_s[static_cast<Eigen::Index>(i)]);
    for (double value : T.translation()) table.Add(value);
    for (double value : {q.w(), q.x(), q.y(), q.z()}) table.Add(value);
    table.EndRow();
  }
  WriteFile(file, table.text());
}

}  // namespace elastocal
