// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace elastocal::cli {

/// Numbers with an uncertainty, as all texts of the program print them: the standard deviation has
/// two significant digits, and the estimate ends at the same decimal place. NaN is printed as "-".

/// "0.012" of 0.0123, "1200" of 1234, "0" of 0, "1.2e-12" below nine decimals.
std::string RoundedSd(double sd);

/// A value that ends where RoundedSd(sd) ends; with four significant digits where sd tells nothing
/// (zero, infinite or NaN).
std::string RoundedTo(double value, double sd);

/// "[-0.12, 0.34]": the interval of `half_width` around `value`, rounded as RoundedTo.
std::string RoundedInterval(double value, double half_width, double sd);

/// A distance in millimetres with this many decimals; "-" where it is not finite.
std::string Millimetres(double metres, int decimals);

}  // namespace elastocal::cli
