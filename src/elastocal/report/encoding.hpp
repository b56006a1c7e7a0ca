// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <istream>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// SHA-256 of bytes as 64 hexadecimal digits: tells whether an input is the same file.
std::string Sha256(std::string_view bytes);

/// The same of what a stream still holds, whose length is added to `count`; read piece by piece.
std::string Sha256(std::istream& stream, std::size_t& count);

/// Base64 (RFC 4648, with padding) of bytes.
std::string Base64(std::string_view bytes);

/// Numbers as 32-bit floats, little-endian, in base64: what the page reads long series from.
/// Matrices row by row; NaN stays NaN.
std::string Base64Floats(const std::vector<double>& values);
std::string Base64Floats(const Eigen::MatrixXd& values);

/// A number with `digits` significant ones: what is beyond is not worth its place in a file.
double Rounded(double value, int digits = 5);

}  // namespace elastocal
