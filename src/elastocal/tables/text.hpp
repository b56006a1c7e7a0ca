// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace elastocal {

/// A text in the form in which a message shows it: in quotes, clipped if long, with control
/// characters as '?' and bytes that are not UTF-8 as U+FFFD.
std::string Quote(std::string_view text);

/// "file:line: ", the beginning of messages about a line.
std::string Place(const std::string& source, int line);

/// The text without spaces, tabs and line ends at its beginning and end.
std::string_view Trim(std::string_view text);

/// The whole text as a finite number in the notation of C, whatever the locale; spaces around it
/// are ignored. Nothing for any other text ("1,5", "nan", "1e999", "2 3").
std::optional<double> ParseNumber(std::string_view text);

/// Whether a cell of a table stands for a number that was not measured: it is empty, NaN or NULL,
/// in small or capital letters.
bool IsGap(std::string_view cell);

/// The shortest decimal text that reads back as the same double.
std::string FormatNumber(double value);

/// Appends a number to `text`: as FormatNumber (AppendNumber), or with `decimals` digits after the
/// point (AppendFixed).
void AppendNumber(double value, std::string& text);
void AppendFixed(double value, int decimals, std::string& text);

}  // namespace elastocal
