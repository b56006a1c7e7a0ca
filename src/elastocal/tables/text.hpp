// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace elastocal {

/// 'text' as it is shown in a message: in quotes, long text clipped, control characters as '?',
/// what is not UTF-8 as U+FFFD.
std::string Quote(std::string_view text);

/// "file:line: ", how messages about a line begin.
std::string Place(const std::string& source, int line);

/// The text without spaces, tabs and line ends around it.
std::string_view Trim(std::string_view text);

/// The whole text, spaces around it aside, as a finite number in the notation of C, whatever the
/// locale; nothing where it is anything else ("1,5", "nan", "1e999", "2 3").
std::optional<double> ParseNumber(std::string_view text);

/// Whether a cell of a table stands for a number that was not measured: it is empty, NaN or NULL,
/// in small or capital letters.
bool IsGap(std::string_view cell);

/// The shortest decimal text that reads back as the same double.
std::string FormatNumber(double value);

/// Adds such a text, or one with so many digits behind the point, to the end of another.
void AppendNumber(double value, std::string& text);
void AppendFixed(double value, int decimals, std::string& text);

}  // namespace elastocal
