// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <istream>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// SHA-256 of bytes as 64 hexadecimal digits, by which files are compared.
std::string Sha256(std::string_view bytes);

/// SHA-256 of the rest of a stream, read piece by piece; its length is added to `count`.
std::string Sha256(std::istream& stream, std::size_t& count);

/// Base64 (RFC 4648, with padding) of bytes.
std::string Base64(std::string_view bytes);

/// Numbers as 32-bit floats, little-endian, in base64, from which the page reads long series.
/// Matrices row by row; NaN stays NaN.
std::string Base64Floats(const std::vector<double>& values);
std::string Base64Floats(const Eigen::MatrixXd& values);

/// A number rounded to `digits` significant digits, which keeps files small.
double Rounded(double value, int digits = 5);

}  // namespace elastocal
