// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace elastocal {

/// A name in a form that every YAML reader reads back as this text, and not as a number, a truth
/// value or nothing: as it is, or in double quotes.
std::string YamlWord(const std::string& text);

}  // namespace elastocal
