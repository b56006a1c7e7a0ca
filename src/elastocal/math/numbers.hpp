#pragma once

#include <cstddef>
#include <limits>

namespace elastocal {

/// Stands for what was not measured.
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Standard deviation of normal noise over its median absolute deviation.
inline constexpr double kNormalMad = 1.4826;

/// An index or count, which Eigen has signed, as the standard library wants it.
inline std::size_t Size(std::ptrdiff_t i) { return static_cast<std::size_t>(i); }

}  // namespace elastocal
