// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace elastocal {

/// Whether all of `text` is UTF-8 (plain ASCII is).
bool IsUtf8(std::string_view text);

/// Throws InputError naming file and line if `text` is not UTF-8. Its first line is line
/// `first_line` of the file `source`. Names from files end up in JSON, which must be UTF-8;
/// therefore every reader of names calls this first.
void RequireUtf8(std::string_view text, const std::string& source, int first_line = 1);

/// The text in a form that is safe on a terminal. Bytes that are not UTF-8 become U+FFFD. Control
/// characters other than line ends and tabs become '?', because they could command the terminal.
std::string Printable(std::string_view text);

}  // namespace elastocal
