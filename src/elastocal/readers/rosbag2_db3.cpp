// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstring>
#include <memory>

#include <sqlite3.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/readers/formats.hpp"
#include "elastocal/readers/ros_messages.hpp"

namespace elastocal {
namespace {

constexpr std::string_view kSqliteMagic("SQLite format 3\0", 16);

constexpr const char* kCutOff =
    "the database is damaged or was cut off (`elastocal convert --salvage` takes what is before)";

/// The database of a bag, open for reading.
class Database {
 public:
  Database(const ByteSource& source, bool salvage) : source_(source) {
    const bool file = !source.path().empty();
    sqlite3* opened = nullptr;
    const int result =
        sqlite3_open_v2(file ? source.path().c_str() : ":memory:", &opened,
                        file ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE, nullptr);
    database_.reset(opened);
    if (result != SQLITE_OK) Fail("the database cannot be opened");
    if (!file) Load();
    // Without this, SQLite reads nothing of a file that is shorter than its head says.
    if (salvage) sqlite3_exec(opened, "PRAGMA writable_schema=ON", nullptr, nullptr, nullptr);
    sqlite3_limit(opened, SQLITE_LIMIT_LENGTH, 512 << 20);
  }

  /// A statement whose rows are then stepped through.
  class Rows {
   public:
    Rows(const Database& database, const char* sql) : database_(database) {
      sqlite3_stmt* statement = nullptr;
      if (sqlite3_prepare_v2(database.get(), sql, -1, &statement, nullptr) != SQLITE_OK) {
        const bool cut = sqlite3_errcode(database.get()) == SQLITE_CORRUPT;
        database.Fail(cut ? kCutOff
                          : "its tables are not those of a bag (or it was copied without the file "
                            "-wal beside it, which a recorder that was not closed leaves)");
      }
      statement_.reset(statement);
    }
    /// With `damaged`, that the next row cannot be read is no error, but said there.
    bool Next(bool* damaged = nullptr) {
      const int result = sqlite3_step(statement_.get());
      if (result == SQLITE_ROW) return true;
      if (result == SQLITE_DONE) return false;
      if (damaged == nullptr) database_.Fail(kCutOff);
      *damaged = true;
      return false;
    }
    std::int64_t Number(int column) const { return sqlite3_column_int64(statement_.get(), column); }
    std::string Text(int column) const {
      const unsigned char* const text = sqlite3_column_text(statement_.get(), column);
      const auto length = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
      return text ? std::string(reinterpret_cast<const char*>(text), length) : std::string();
    }
    std::span<const char> Bytes(int column) const {
      const auto* const bytes =
          static_cast<const char*>(sqlite3_column_blob(statement_.get(), column));
      const auto count = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
      return bytes ? std::span(bytes, count) : std::span<const char>();
    }

   private:
    const Database& database_;
    std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)> statement_{nullptr,
                                                                          sqlite3_finalize};
  };

  sqlite3* get() const { return database_.get(); }

  /// SQLite says what is wrong; where a page is, only it knows.
  [[noreturn]] void Fail(const std::string& message) const {
    const char* const reason = database_ ? sqlite3_errmsg(database_.get()) : "no memory";
    throw InputError(source_.name() + ": " + message + ": " + reason);
  }

 private:
  /// Bytes in memory, as a database that can be read.
  void Load() {
    const std::string_view bytes = source_.memory();
    auto* const copy = static_cast<unsigned char*>(sqlite3_malloc64(bytes.size()));
    if (!copy) Fail("the database cannot be opened");
    std::memcpy(copy, bytes.data(), bytes.size());
    const auto size = static_cast<sqlite3_int64>(bytes.size());
    if (sqlite3_deserialize(database_.get(), "main", copy, size, size,
                            SQLITE_DESERIALIZE_FREEONCLOSE | SQLITE_DESERIALIZE_READONLY) !=
        SQLITE_OK) {
      Fail("the database cannot be opened");
    }
  }

  const ByteSource& source_;
  std::unique_ptr<sqlite3, decltype(&sqlite3_close)> database_{nullptr, sqlite3_close};
};

/// Adds what one file of a bag holds; with `salvage`, up to where it is damaged. That, in words, or
/// nothing.
std::string ReadDatabase(const ByteSource& source, bool salvage, RosMessages& messages) {
  // A file that was cut off is shorter than its head says; SQLite would notice only later.
  std::array<char, 32> head{};
  source.ReadAll(0, head, "the head of the database");
  const Database database(source, salvage);
  messages.BeginPiece();
  std::string wanted;
  Database::Rows topics(database, "SELECT id, name, type, serialization_format FROM topics");
  while (topics.Next()) {
    const std::string format = topics.Text(3);
    const bool cdr = format.empty() || format == "cdr";
    const bool needed =
        messages.AddTopic(static_cast<std::uint64_t>(topics.Number(0)), topics.Text(1),
                          cdr ? topics.Text(2) : "format " + format, RosEncoding::kCdr);
    if (needed) wanted += (wanted.empty() ? "" : ",") + std::to_string(topics.Number(0));
  }
  const std::string sql = "SELECT id, topic_id, timestamp, data FROM messages WHERE topic_id IN (" +
                          wanted + ") ORDER BY id";
  Database::Rows rows(database, sql.c_str());
  bool damaged = false;
  std::int64_t last = 0;
  while (rows.Next(salvage ? &damaged : nullptr)) {
    if (salvage && rows.Bytes(3).empty()) damaged = true;  // its pages are not there
    if (damaged) break;
    last = rows.Number(0);
    messages.Add(static_cast<std::uint64_t>(rows.Number(1)), rows.Bytes(3), rows.Number(2),
                 "messages, row " + std::to_string(rows.Number(0)) + ": ");
  }
  if (!damaged) return "";
  return source.name() + " is damaged or was cut off: it is read up to row " +
         std::to_string(last) + " of its messages";
}

}  // namespace

bool IsRosbag2Db3(std::string_view head) { return head.starts_with(kSqliteMagic); }

RecordingFile ReadRosbag2Db3(const ByteSource& source, const ReaderOptions& options) {
  RosMessages messages(source.name(), options);
  std::vector<std::string> salvaged;
  ForEachPiece(source, [&](const ByteSource& piece) {
    const std::string end = ReadDatabase(piece, options.salvage, messages);
    if (!end.empty()) salvaged.push_back(end);
  });
  RecordingFile file = messages.Take();
  file.notes.insert(file.notes.begin(), salvaged.begin(), salvaged.end());
  file.salvaged = std::move(salvaged);
  return file;
}

}  // namespace elastocal
