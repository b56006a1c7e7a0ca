// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/covariance_file.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/table_reader.hpp"
#include "elastocal/tables/table_writer.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

const char* const kNameColumn = "parameter";
constexpr double kSameVariance = 1e-6;  // relative: both files have all digits
constexpr std::size_t kMostParameters = 5000;

/// Checks the names of the columns and returns, in their order, the parameters of the calibration.
std::vector<const ParameterEstimate*> FindParameters(const Table& table,
                                                     const CalibrationEstimate& estimate) {
  const std::vector<std::string>& header = table.header();
  if (header[0] != kNameColumn) {
    table.Fail("expected a row of names that begins with 'parameter'");
  }
  if (header.size() > kMostParameters + 1) {
    table.Fail(std::to_string(header.size() - 1) + " parameters; at most " +
               std::to_string(kMostParameters) + " are read");
  }
  const std::size_t count = estimate.parameters.size();
  ColumnRoles roles = {{kNameColumn, kPassedOver}};
  for (std::size_t k = 0; k < count; ++k) {
    roles[estimate.parameters[k].name] = static_cast<int>(k);
  }
  const std::vector<int> columns =
      FindColumns(table, roles, count, "the calibration has no parameter of this name");
  std::vector<const ParameterEstimate*> parameters(header.size() - 1);
  for (std::size_t k = 0; k < count; ++k) {
    const ParameterEstimate& parameter = estimate.parameters[k];
    if (columns[k] > 0) {
      parameters[static_cast<std::size_t>(columns[k] - 1)] = &parameter;
    } else if (parameter.status == ParameterStatus::kEstimated) {
      table.Fail("no parameter " + Quote(parameter.name) + ", which the calibration estimates");
    }
  }
  // A second column of names.
  if (std::find(parameters.begin(), parameters.end(), nullptr) != parameters.end()) {
    table.Fail("the column 'parameter' comes twice");
  }
  return parameters;
}

/// Checks row `i` of a covariance that is filled up to there.
void CheckRow(const Table& table, double sd, const Eigen::MatrixXd& covariance, Eigen::Index i) {
  const double variance = sd * sd;
  const auto column = static_cast<int>(i) + 1;
  if (!(std::abs(covariance(i, i) - variance) <= kSameVariance * variance)) {
    table.FailCell(column, "the variance is " + FormatNumber(covariance(i, i)) +
                               ", but by the sd in the calibration it is " +
                               FormatNumber(variance) +
                               ": this covariance belongs to another calibration");
  }
  for (Eigen::Index j = 0; j < i; ++j) {
    const double scale = std::sqrt(covariance(i, i) * covariance(j, j));
    if (std::abs(covariance(i, j) - covariance(j, i)) <= kSameVariance * scale) continue;
    table.FailCell(static_cast<int>(j) + 1,
                   FormatNumber(covariance(i, j)) + " is not what stands on the other side, " +
                       FormatNumber(covariance(j, i)) + "; a covariance is symmetric");
  }
}

}  // namespace

std::string MakeCovarianceCsv(const CalibrationResult& result) {
  std::vector<std::string> names;
  for (int i : result.posterior.parameters) names.push_back(result.model.parameters[i].name);
  return MakeCovarianceCsv(names, result.posterior.covariance);
}

std::string MakeCovarianceCsv(const std::vector<std::string>& names,
                              const Eigen::MatrixXd& covariance) {
  TableWriter table;
  table.Add(kNameColumn);
  for (const std::string& name : names) table.Add(name);
  table.EndRow();
  for (std::size_t row = 0; row < names.size(); ++row) {
    table.Add(names[row]);
    for (double entry : covariance.row(static_cast<Eigen::Index>(row))) table.Add(entry);
    table.EndRow();
  }
  return table.text();
}

void ReadCovariance(const std::filesystem::path& file, CalibrationEstimate& estimate) {
  std::istringstream stream = OpenTable(file);
  ReadCovariance(stream, file.string(), estimate);
}

void ReadCovariance(std::istream& stream, const std::string& source,
                    CalibrationEstimate& estimate) {
  Table table(stream, source);
  const std::vector<const ParameterEstimate*> parameters = FindParameters(table, estimate);
  const auto size = static_cast<Eigen::Index>(parameters.size());
  estimate.covariance.resize(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const ParameterEstimate& parameter = *parameters[static_cast<std::size_t>(i)];
    if (!table.Next()) table.Fail("the file ends before the row of " + Quote(parameter.name));
    if (table.Cell(0) != parameter.name) {
      table.FailCell(0, "found " + Quote(table.Cell(0)) + "; " + Quote(parameter.name) +
                            " was expected, in the order of the header");
    }
    for (Eigen::Index j = 0; j < size; ++j) {
      estimate.covariance(i, j) = table.Number(static_cast<int>(j) + 1);
    }
    CheckRow(table, parameter.sd, estimate.covariance, i);
  }
  if (table.Next()) table.Fail("a row too many");
  estimate.covariance_names.assign(table.header().begin() + 1, table.header().end());
}

}  // namespace elastocal
