// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstring>
#include <filesystem>
#include <memory>

#include <fcntl.h>
#include <sqlite3.h>
#include <sys/mman.h>
#include <unistd.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/readers/formats.hpp"
#include "elastocal/readers/ros_messages.hpp"

namespace elastocal {
namespace {

constexpr std::string_view kSqliteMagic("SQLite format 3\0", 16);

constexpr const char* kCutOff =
    "the database is damaged or was cut off (`elastocal convert --salvage` takes what is before)";

/// The header of a database.
struct DatabaseHead {
  std::uint64_t page = 0;     ///< bytes; the file has whole pages
  bool writes_ahead = false;  ///< to a file -wal beside it
};

constexpr std::uint64_t kWriteVersion = 18, kReadVersion = 19;  // bytes of the head

DatabaseHead ReadHead(const ByteSource& source) {
  std::array<char, 32> head{};
  source.ReadAll(0, head, "the head of the database");
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(head[i]); };
  const unsigned page = 256u * byte(16) + byte(17);
  return {page == 1 ? 65536u : page, byte(kReadVersion) == 2};
}

/// Whether a database writes ahead, but the file to which it writes is missing.
bool LacksWal(const ByteSource& source, const DatabaseHead& head) {
  std::error_code error;
  return head.writes_ahead && !source.path().empty() &&
         !std::filesystem::exists(source.path().string() + "-wal", error);
}

/// A file as it would be in memory; pages that are not read take none.
class MappedFile {
 public:
  explicit MappedFile(const ByteSource& source) : size_(source.size()) {
    const int descriptor = open(source.path().c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) source.Fail(0, "cannot be read");
    // What is changed in memory is not changed in the file.
    void* const mapped = mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_PRIVATE, descriptor, 0);
    close(descriptor);
    if (mapped == MAP_FAILED) source.Fail(0, "cannot be read");
    bytes_ = static_cast<unsigned char*>(mapped);
  }
  ~MappedFile() { munmap(bytes_, size_); }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  unsigned char* bytes() const { return bytes_; }

 private:
  std::uint64_t size_;
  unsigned char* bytes_ = nullptr;
};

/// The database of a bag, open for reading.
class Database {
 public:
  Database(const ByteSource& source, bool salvage) : source_(source) {
    const DatabaseHead head = ReadHead(source);
    const std::uint64_t rest = head.page > 0 ? source.size() % head.page : 0;
    // SQLite would read zeros where the last page ends.
    if (rest != 0 && !salvage) throw InputError(source.name() + ": " + kCutOff);
    const bool file = !source.path().empty();
    // SQLite would leave files beside it.
    const bool mapped = file && (rest != 0 || LacksWal(source, head));
    sqlite3* opened = nullptr;
    const int result =
        sqlite3_open_v2(file && !mapped ? source.path().c_str() : ":memory:", &opened,
                        file && !mapped ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE, nullptr);
    database_.reset(opened);
    if (result != SQLITE_OK) Fail("the database cannot be opened");
    if (mapped) Map(source.size() - rest);
    if (!file) Load(source.size() - rest);
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
    /// Steps to the next row. If it cannot be read, this is an error or, with `damaged`, noted
    /// there.
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

  /// Throws InputError with SQLite's message. Only SQLite knows the place in the file.
  [[noreturn]] void Fail(const std::string& message) const {
    const char* const reason = database_ ? sqlite3_errmsg(database_.get()) : "no memory";
    throw InputError(source_.name() + ": " + message + ": " + reason);
  }

 private:
  /// The first bytes of what is in memory, as a database that can be read.
  void Load(std::uint64_t size) {
    auto* const copy = static_cast<unsigned char*>(sqlite3_malloc64(size));
    if (!copy) Fail("the database cannot be opened");
    std::memcpy(copy, source_.memory().data(), size);
    Deserialize(copy, size, SQLITE_DESERIALIZE_FREEONCLOSE);
  }

  /// The first bytes of a file alone, whatever stands beside it.
  void Map(std::uint64_t size) {
    mapped_ = std::make_unique<MappedFile>(source_);
    // Nothing is written ahead of it any more.
    if (size > kReadVersion) mapped_->bytes()[kWriteVersion] = mapped_->bytes()[kReadVersion] = 1;
    Deserialize(mapped_->bytes(), size, 0);
  }

  void Deserialize(unsigned char* bytes, std::uint64_t size, unsigned flags) {
    const auto count = static_cast<sqlite3_int64>(size);
    if (sqlite3_deserialize(database_.get(), "main", bytes, count, count,
                            flags | SQLITE_DESERIALIZE_READONLY) != SQLITE_OK) {
      Fail("the database cannot be opened");
    }
  }

  const ByteSource& source_;
  std::unique_ptr<MappedFile> mapped_;
  std::unique_ptr<sqlite3, decltype(&sqlite3_close)> database_{nullptr, sqlite3_close};
};

/// Adds the messages of one file of a bag; with `salvage`, up to where it is damaged. Returns a
/// sentence about the damage, or an empty text.
std::string ReadDatabase(const ByteSource& source, bool salvage, RosMessages& messages) {
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
  std::vector<std::string> salvaged, notes;
  ForEachPiece(source, [&](const ByteSource& piece) {
    if (LacksWal(piece, ReadHead(piece))) {
      notes.push_back(
          piece.name() +
          " was written with a file -wal beside it, which is not there: if its recorder "
          "was not closed, the last messages are missing");
    }
    const std::string end = ReadDatabase(piece, options.salvage, messages);
    if (!end.empty()) salvaged.push_back(end);
  });
  RecordingFile file = messages.Take();
  file.notes.insert(file.notes.begin(), notes.begin(), notes.end());
  file.notes.insert(file.notes.begin(), salvaged.begin(), salvaged.end());
  file.salvaged = std::move(salvaged);
  return file;
}

}  // namespace elastocal
