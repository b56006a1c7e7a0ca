// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "elastocal/readers/byte_source.hpp"

namespace elastocal {

/// The three kinds of processors whose numbers a C3D file may hold.
enum class C3dProcessor { kIntel = 84, kDec = 85, kMips = 86 };

/// Numbers of 16 and 32 bits as that processor stores them.
std::int16_t C3dInteger(const char* bytes, C3dProcessor processor);
float C3dReal(const char* bytes, C3dProcessor processor);

/// A parameter of a C3D file: texts or numbers.
struct C3dParameter {
  std::uint64_t offset = 0;  ///< of its values in the file
  std::vector<std::string> texts;
  std::vector<double> numbers;  ///< integers of 16 bits from -32768 to 32767
  bool integers = false;        ///< of 16 bits
};

/// The parameter section, under names in capitals: "POINT:LABELS".
struct C3dParameters {
  C3dProcessor processor = C3dProcessor::kIntel;
  std::map<std::string, C3dParameter> values;

  const C3dParameter* Find(const std::string& name) const;
  /// The first text, without spaces around it; empty if there is none.
  std::string Text(const std::string& name) const;
  /// Number i, with integers taken as unsigned; `otherwise` if there is none.
  double Unsigned(const std::string& name, double otherwise, std::size_t i = 0) const;
};

/// Reads the section that the first byte of the header points to. Throws InputError naming the
/// byte.
C3dParameters ReadC3dParameters(const ByteSource& source);

}  // namespace elastocal
