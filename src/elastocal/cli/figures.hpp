// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace elastocal::cli {

/// Formatting of numbers with an uncertainty, for all texts of the program: the standard deviation
/// has two significant digits, and the estimate ends at the same decimal place. NaN is printed as
/// "-".

/// A standard deviation as text: "0.012" for 0.0123, "1200" for 1234, "0" for 0, "1.2e-12" below
/// nine decimals.
std::string RoundedSd(double sd);

/// A value that ends at the decimal place of RoundedSd(sd). It has four significant digits if sd is
/// zero, infinite or NaN.
std::string RoundedTo(double value, double sd);

/// The interval of `half_width` around `value`, rounded as in RoundedTo: "[-0.12, 0.34]".
std::string RoundedInterval(double value, double half_width, double sd);

/// A distance in millimetres with this many decimals; "-" where it is not finite.
std::string Millimetres(double metres, int decimals);

}  // namespace elastocal::cli
