// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <numbers>

namespace elastocal {

/// Stands for a value that was not measured.
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Standard deviation of normal noise over its median absolute deviation.
inline constexpr double kNormalMad = 1.4826;

/// Units of files.
inline constexpr double kMetresPerMm = 1e-3;
inline constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

/// An index or count, which Eigen has signed, as the standard library wants it.
inline std::size_t Size(std::ptrdiff_t i) { return static_cast<std::size_t>(i); }

}  // namespace elastocal
