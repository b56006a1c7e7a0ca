#include "elastocal/io/covariance_file.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "elastocal/io/table_lines.hpp"
#include "elastocal/io/text.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

constexpr double kSameVariance = 1e-6;  // relative: both files have all digits
constexpr std::size_t kMostParameters = 5000;

using ByName = std::map<std::string, const ParameterEstimate*>;

std::vector<std::string> ReadHeader(TableLines& lines, const std::string& source,
                                    const ByName& known) {
  std::vector<std::string> header;
  if (!lines.Next(header) || header[0] != "parameter") {
    throw InputError(Place(source, 1) + "expected a row of names that begins with 'parameter'");
  }
  header.erase(header.begin());
  if (header.size() > kMostParameters) {
    throw InputError(Place(source, 1) + std::to_string(header.size()) + " parameters; at most " +
                     std::to_string(kMostParameters) + " are read");
  }
  std::vector<std::string> sorted = header;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) {
    throw InputError(Place(source, 1) + "parameter " + Quote(*twice) + " is given twice");
  }
  for (const std::string& name : header) {
    if (known.contains(name)) continue;
    throw InputError(Place(source, 1) + "parameter " + Quote(name) + " is not in the calibration");
  }
  return header;
}

/// Fills row `i` of the covariance from the cells of a line and checks it against those above.
void ReadRow(const std::vector<std::string>& cells, const std::string& source, int line,
             const ParameterEstimate& parameter, Eigen::Index i, CalibrationEstimate& estimate) {
  const std::vector<std::string>& names = estimate.covariance_names;
  if (cells.size() != names.size() + 1 || cells[0] != parameter.name) {
    throw InputError(Place(source, line) + "expected the name " + Quote(parameter.name) + " and " +
                     std::to_string(names.size()) + " numbers, found " +
                     std::to_string(cells.size()) + " cells that begin with " + Quote(cells[0]));
  }
  for (std::size_t j = 0; j < names.size(); ++j) {
    estimate.covariance(i, static_cast<Eigen::Index>(j)) =
        CellNumber(cells[j + 1], names[j], source, line);
  }
  const Eigen::MatrixXd& covariance = estimate.covariance;
  const double variance = parameter.sd * parameter.sd;
  if (!(std::abs(covariance(i, i) - variance) <= kSameVariance * variance)) {
    throw InputError(Place(source, line) + "the variance of " + Quote(parameter.name) + " is " +
                     FormatNumber(covariance(i, i)) + ", but by its sd in the calibration it is " +
                     FormatNumber(variance) + ": this covariance belongs to another calibration");
  }
  for (Eigen::Index j = 0; j < i; ++j) {
    const double scale = std::sqrt(covariance(i, i) * covariance(j, j));
    if (std::abs(covariance(i, j) - covariance(j, i)) <= kSameVariance * scale) continue;
    throw InputError(Place(source, line) + "column " + Quote(names[j]) + ": " +
                     FormatNumber(covariance(i, j)) + " is not what stands on the other side, " +
                     FormatNumber(covariance(j, i)) + "; a covariance is symmetric");
  }
}

}  // namespace

std::string MakeCovarianceCsv(const CalibrationResult& result) {
  const std::vector<int>& parameters = result.posterior.parameters;
  std::string text = "parameter";
  for (int i : parameters) text += "," + result.model.parameters[i].name;
  text += "\n";
  for (std::size_t row = 0; row < parameters.size(); ++row) {
    text += result.model.parameters[parameters[row]].name;
    for (std::size_t column = 0; column < parameters.size(); ++column) {
      text += "," + FormatNumber(result.posterior.covariance(static_cast<Eigen::Index>(row),
                                                             static_cast<Eigen::Index>(column)));
    }
    text += "\n";
  }
  return text;
}

void ReadCovariance(const std::filesystem::path& file, CalibrationEstimate& estimate) {
  std::ifstream stream = OpenTable(file);
  ReadCovariance(stream, file.string(), estimate);
}

void ReadCovariance(std::istream& stream, const std::string& source,
                    CalibrationEstimate& estimate) {
  ByName known;
  for (const ParameterEstimate& parameter : estimate.parameters) known[parameter.name] = &parameter;
  TableLines lines(stream, source);
  estimate.covariance_names = ReadHeader(lines, source, known);
  const auto size = static_cast<Eigen::Index>(estimate.covariance_names.size());
  estimate.covariance.resize(size, size);
  std::vector<std::string> cells;
  for (Eigen::Index i = 0; i < size; ++i) {
    const std::string& name = estimate.covariance_names[i];
    if (!lines.Next(cells)) {
      throw InputError(Place(source, lines.line()) + "the file ends before the row of " +
                       Quote(name));
    }
    ReadRow(cells, source, lines.line(), *known.at(name), i, estimate);
  }
  if (lines.Next(cells)) throw InputError(Place(source, lines.line()) + "a row too many");
  for (const ParameterEstimate& parameter : estimate.parameters) {
    const bool missing =
        parameter.status == ParameterStatus::kEstimated &&
        std::find(estimate.covariance_names.begin(), estimate.covariance_names.end(),
                  parameter.name) == estimate.covariance_names.end();
    if (missing) {
      throw InputError(Place(source, 1) + "no parameter " + Quote(parameter.name) +
                       ", which the calibration estimates");
    }
  }
}

}  // namespace elastocal
