// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace elastocal {

/// Whether all of `text` is UTF-8 (plain ASCII is).
bool IsUtf8(std::string_view text);

/// Throws InputError naming file and line where `text`, whose first line is `first_line` of the
/// file `source`, is not UTF-8. Names from texts end up in JSON, which can hold nothing else, so
/// every reader of names asks before any work is done with them.
void RequireUtf8(std::string_view text, const std::string& source, int first_line = 1);

/// The text as a terminal may show it: what is not UTF-8 as U+FFFD, control characters other than
/// line ends and tabs, with which a name could command the terminal, as '?'.
std::string Printable(std::string_view text);

}  // namespace elastocal
