#include "elastocal/io/table_lines.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <istream>

// libfccp would start a thread for every file otherwise.
#define CSV_IO_NO_THREAD
#include <libfccp/csv.h>

#include "elastocal/io/text.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/utf8.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kLongestLine = 1u << 20;

/// Bytes as libfccp's LineReader needs them: without NUL, at which its lines would end, and with a
/// line end at the end, for want of which it can run beyond its data in files above 32 MiB.
class CheckedBytes : public io::ByteSourceBase {
 public:
  CheckedBytes(std::istream& stream, const std::string& source)
      : stream_(stream), source_(source) {}

  int read(char* buffer, int size) override {
    stream_.read(buffer, size);
    int count = static_cast<int>(stream_.gcount());
    if (stream_.bad()) throw InputError(source_ + ": cannot be read");
    const char* nul = std::find(buffer, buffer + count, '\0');
    if (nul != buffer + count) {
      const auto line = lines_ + 1 + std::count<const char*>(buffer, nul, '\n');
      throw InputError(Place(source_, static_cast<int>(line)) +
                       "found a NUL byte; a table (text) was expected");
    }
    lines_ += std::count(buffer, buffer + count, '\n');
    if (count > 0) last_ = buffer[count - 1];
    if (count < size && last_ != '\n') last_ = buffer[count++] = '\n';
    return count;
  }

 private:
  std::istream& stream_;
  const std::string& source_;
  std::ptrdiff_t lines_ = 0;
  char last_ = '\n';
};

/// The one of the separators that the header has most of.
char FindSeparator(std::string_view header) {
  char best = ',';
  std::ptrdiff_t most = 0;
  for (char candidate : {',', ';', '\t'}) {
    const std::ptrdiff_t count = std::count(header.begin(), header.end(), candidate);
    if (count > most) best = candidate;
    most = std::max(most, count);
  }
  return best;
}

void SkipSpaces(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(" \r"), line.size()));
}

/// Takes the quoted cell at the beginning of `line`; false where its quote does not end.
bool TakeQuoted(std::string_view& line, std::string& cell) {
  SkipSpaces(line);
  line.remove_prefix(1);
  for (;;) {
    const std::size_t quote = line.find('"');
    if (quote == std::string_view::npos) return false;
    cell += line.substr(0, quote);
    line.remove_prefix(quote + 1);
    if (!line.starts_with('"')) break;
    cell += '"';
    line.remove_prefix(1);
  }
  SkipSpaces(line);
  return true;
}

}  // namespace

std::ifstream OpenTable(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error) && !error) {
    throw InputError(file.string() + ": there is no such file");
  }
  if (std::filesystem::is_directory(file, error)) throw InputError(file.string() + ": is a folder");
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file.string() + ": cannot be read: " + std::strerror(errno));
  return stream;
}

class TableLines::Lines {
 public:
  Lines(std::istream& stream, const std::string& source)
      : reader_(source, std::make_unique<CheckedBytes>(stream, source)) {}

  const char* Next() { return reader_.next_line(); }

 private:
  io::LineReader reader_;
};

TableLines::TableLines(std::istream& stream, const std::string& source)
    : source_(source), lines_(std::make_unique<Lines>(stream, source_)) {}

TableLines::~TableLines() = default;

bool TableLines::NextLine(std::string_view& text) {
  ++line_;
  bool too_long = false;
  try {
    const char* line = lines_->Next();
    if (line == nullptr) return false;
    text = line;
  } catch (const io::error::line_length_limit_exceeded&) {
    too_long = true;
  }
  if (too_long || text.size() > kLongestLine) {
    throw InputError(Place(source_, line_) + "a line of more than 1 MiB");
  }
  return true;
}

bool TableLines::Next(std::vector<std::string>& cells) {
  std::string_view text;
  if (!NextLine(text)) return false;
  if (Trim(text).empty()) {
    const int first_empty = line_;
    while (NextLine(text)) {
      if (!Trim(text).empty()) {
        throw InputError(Place(source_, first_empty) + "an empty line above further rows");
      }
    }
    return false;
  }
  if (separator_ == '\0') {
    RequireUtf8(text, source_, line_);
    separator_ = FindSeparator(text);
  }
  if (!SplitCells(text, separator_, cells)) {
    throw InputError(Place(source_, line_) + "quotes that do not enclose a whole cell");
  }
  return true;
}

bool SplitCells(std::string_view line, char separator, std::vector<std::string>& cells) {
  // The strings of the row before are used again: a motion has millions of cells.
  std::size_t count = 0;
  for (;;) {
    if (count == cells.size()) cells.emplace_back();
    std::string& cell = cells[count++];
    const std::size_t end = std::min(line.find(separator), line.size());
    const std::string_view text = Trim(line.substr(0, end));
    if (!text.starts_with('"')) {
      cell = text;
      line.remove_prefix(end);
    } else {
      cell.clear();
      if (!TakeQuoted(line, cell)) return false;
    }
    if (line.empty()) {
      cells.resize(count);
      return true;
    }
    if (line[0] != separator) return false;
    line.remove_prefix(1);
  }
}

double CellNumber(const std::string& cell, const std::string& column, const std::string& source,
                  int line) {
  const std::optional<double> number = ParseNumber(cell);
  if (number) return *number;
  throw InputError(Place(source, line) + "column " + Quote(column) + ": found " +
                   (cell.empty() ? "nothing" : Quote(cell)) + "; a finite number was expected" +
                   (cell.find(',') == std::string::npos ? "" : ", with a decimal point"));
}

std::string MakeCell(const std::string& text) {
  if (text.find_first_of(",;\t\"") == std::string::npos) return text;
  std::string cell = "\"";
  for (char character : text) cell += character == '"' ? "\"\"" : std::string(1, character);
  return cell + "\"";
}

}  // namespace elastocal
