#pragma once

#include <string>
#include <string_view>

namespace elastocal {

/// SHA-256 (FIPS 180-4) of bytes as 64 hexadecimal digits: tells whether an input is the same file.
std::string Sha256(std::string_view bytes);

}  // namespace elastocal
