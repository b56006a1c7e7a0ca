// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/lengths.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {

double MetresIn(std::string_view unit) {
  std::string small(Trim(unit));
  std::transform(small.begin(), small.end(), small.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array<std::pair<std::string_view, double>, 13> kUnits = {{{"mm", 1e-3},
                                                                           {"millimeters", 1e-3},
                                                                           {"millimetres", 1e-3},
                                                                           {"cm", 1e-2},
                                                                           {"centimeters", 1e-2},
                                                                           {"centimetres", 1e-2},
                                                                           {"m", 1.0},
                                                                           {"meters", 1.0},
                                                                           {"metres", 1.0},
                                                                           {"in", 0.0254},
                                                                           {"inches", 0.0254},
                                                                           {"ft", 0.3048},
                                                                           {"feet", 0.3048}}};
  for (const auto& [name, metres] : kUnits) {
    if (small == name) return metres;
  }
  return 0.0;
}

double UnitOf(std::string_view stated, const std::string& given, const std::string& source) {
  stated = Trim(stated);
  const double by_file = MetresIn(stated), by_user = MetresIn(given);
  if (!given.empty() && by_user == 0.0) {
    throw InputError("the unit " + Quote(given) + " is not known; mm, cm, m or in was expected");
  }
  if (by_file > 0.0 && by_user > 0.0 && by_file != by_user) {
    throw InputError(source + ": states the unit " + Quote(stated) + ", not " + Quote(given));
  }
  if (by_user > 0.0) return by_user;
  if (by_file > 0.0) return by_file;
  throw InputError(source +
                   (stated.empty() ? ": does not state its unit of length"
                                   : ": states the unknown unit of length " + Quote(stated)) +
                   "; give it: markers_unit of the trial in experiment.yaml, or the option --unit "
                   "(mm, cm, m or in)");
}

}  // namespace elastocal
