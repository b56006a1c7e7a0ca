// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <map>
#include <memory>
#include <optional>

#include <zip.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/readers/formats.hpp"
#include "elastocal/readers/joint_columns.hpp"
#include "elastocal/readers/npy_array.hpp"
#include "elastocal/readers/times.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kMostLogSamples = 1000000;
constexpr std::size_t kMostArrays = 10000;

/// An archive that is open for reading.
class ZipArchive {
 public:
  explicit ZipArchive(const ByteSource& source) : source_(source) {
    zip_error_t error;
    zip_error_init(&error);
    zip_source_t* const bytes =
        source.path().empty()
            ? zip_source_buffer_create(source.memory().data(), source.memory().size(), 0, &error)
            : zip_source_file_create(source.path().c_str(), 0, -1, &error);
    if (bytes) {
      archive_.reset(zip_open_from_source(bytes, ZIP_RDONLY, &error));
      if (!archive_) zip_source_free(bytes);
    }
    const std::string reason = archive_ ? "" : zip_error_strerror(&error);
    zip_error_fini(&error);
    if (!archive_) {
      source.Fail(source.size(),
                  "the directory at the end of the archive cannot be read: " + reason);
    }
  }

  std::size_t count() const {
    return static_cast<std::size_t>(zip_get_num_entries(archive_.get(), 0));
  }
  std::string Name(std::size_t i) const {
    const char* const name = zip_get_name(archive_.get(), i, ZIP_FL_ENC_RAW);
    return name ? name : "";
  }

  /// Reads an array; if it has another shape than `wanted`, only its shape.
  NpyArray Read(std::size_t i, const std::vector<std::size_t>* wanted = nullptr) const {
    const std::string place = source_.name() + ": array " + Quote(Name(i)) + ": ";
    const std::unique_ptr<zip_file_t, decltype(&zip_fclose)> entry(
        zip_fopen_index(archive_.get(), i, 0), zip_fclose);
    if (!entry) throw InputError(place + "cannot be read: " + zip_strerror(archive_.get()));
    std::uint64_t offset = 0;
    const ReadBytes read = [&](std::span<char> to) {
      const zip_int64_t count = zip_fread(entry.get(), to.data(), to.size());
      if (count < 0) {
        throw InputError(place + "byte " + std::to_string(offset) +
                         " of it: " + zip_file_strerror(entry.get()));
      }
      offset += static_cast<std::uint64_t>(count);
      return static_cast<std::size_t>(count);
    };
    NpyArray array = ReadNpy(read, place, wanted);
    if (wanted && *wanted != array.shape) return array;
    // The checksum is compared at the end of the entry.
    std::array<char, 1> more{};
    if (read(more) != 0) throw InputError(place + "bytes behind the elements");
    return array;
  }

 private:
  struct Discard {
    void operator()(zip_t* archive) const { zip_discard(archive); }
  };
  const ByteSource& source_;
  std::unique_ptr<zip_t, Discard> archive_;
};

/// Reads a joint log: the time `t`, and either one array for each joint, or `names` with matrices.
/// Each is an array of its own or a field of records.
class NpzReader {
 public:
  NpzReader(const ByteSource& source, std::string time_unit)
      : source_(source), time_unit_(std::move(time_unit)), archive_(source) {}

  RecordingFile Read() {
    if (archive_.count() > kMostArrays) {
      throw InputError(source_.name() + ": more than 10000 arrays");
    }
    for (std::size_t i = 0; i < archive_.count(); ++i) {
      std::string name = archive_.Name(i);
      if (!name.ends_with(".npy")) continue;
      name.resize(name.size() - 4);
      entries_[name] = i;
    }
    RecordingFile file;
    TakeRecords();
    file.why_no_markers = "an .npz file has joint positions only";
    std::string stated;
    auto time = TakeTime(stated);
    if (!time) {
      file.why_no_joints =
          "it has no array of the time, 't' or 'time' in s (or 't_ms', 'time_ns': the unit "
          "at the end)";
    } else {
      if (time->is_text || time->shape.size() != 1) Fail("'t' is no list of numbers");
      if (time->count() > kMostLogSamples) Fail("more than 1000000 samples");
      if (time->count() == 0) Fail("no sample");
      ToSeconds(stated, time_unit_, source_.name(), time->numbers);
      file.joints = ReadLog(time->numbers);
    }
    for (const auto& [name, i] : entries_)
      notes_.push_back("the array " + name + " is passed over");
    for (const auto& [name, array] : fields_)
      notes_.push_back("the field " + name + " is passed over");
    file.notes = std::move(notes_);
    return file;
  }

 private:
  [[noreturn]] void Fail(const std::string& message) const {
    throw InputError(source_.name() + ": " + message);
  }

  bool HasFields(std::size_t i) const {
    const std::vector<std::size_t> none = {0, 0, 0};  // so that only the head is read
    try {
      return !archive_.Read(i, &none).field_names.empty();
    } catch (const InputError&) {
      return false;  // whoever needs it says what is wrong
    }
  }

  /// The fields of records become arrays of their own, under their names.
  void TakeRecords() {
    const std::map<std::string, std::size_t> entries = entries_;
    for (const auto& [name, i] : entries) {
      if (!HasFields(i)) continue;
      NpyArray records = archive_.Read(i);
      entries_.erase(name);
      for (std::size_t f = 0; f < records.fields.size(); ++f) {
        const std::string& field = records.field_names[f];
        if (fields_.contains(field) || entries.contains(field)) {
          Fail("the field " + Quote(field) + " of " + Quote(name) +
               " has the name of another array or field; one list of records was expected");
        }
        fields_.emplace(field, std::move(records.fields[f]));
      }
    }
  }

  /// Takes the first of these arrays that exists, and removes it from the lists.
  std::optional<NpyArray> Take(std::initializer_list<const char*> names) {
    for (const char* name : names) {
      if (auto field = fields_.extract(name)) return std::move(field.mapped());
      const auto entry = entries_.find(name);
      if (entry == entries_.end()) continue;
      NpyArray array = archive_.Read(entry->second);
      entries_.erase(entry);
      return array;
    }
    return std::nullopt;
  }

  /// The time, and its unit as the type of its numbers or its name states it.
  std::optional<NpyArray> TakeTime(std::string& stated) {
    for (const char* name :
         {"t", "time", "t_s", "time_s", "t_ms", "time_ms", "t_us", "time_us", "t_ns", "time_ns"}) {
      std::optional<NpyArray> time = Take({name});
      if (!time) continue;
      stated = time->unit.empty() ? *TimeUnitOfName(name) : time->unit;
      return time;
    }
    return std::nullopt;
  }

  JointLog ReadLog(const std::vector<double>& time) {
    const auto names = Take({"names", "joint_names", "name"});
    if (names) {
      std::map<std::string, std::vector<double>> joints, efforts;
      if (!names->is_text || names->shape.size() != 1) Fail("'names' is no list of texts");
      if (const auto positions = Take({"positions", "position", "q"})) {
        AddColumns(names->texts, *positions, time.size(), "positions", joints);
      } else {
        Fail("there are names of joints, but no array 'positions' or 'q'");
      }
      if (const auto torques = Take({"torques", "torque", "efforts", "effort", "tau"})) {
        AddColumns(names->texts, *torques, time.size(), "torques", efforts);
      }
      Take({"velocities", "velocity", "dq"});
      if (joints.empty()) Fail("there is no array of any joint beside the time");
      return JoinJoints(source_.name(), time, std::move(joints), std::move(efforts));
    }
    std::map<std::string, std::vector<double>> columns;
    AddArrays(time.size(), columns);
    if (columns.empty()) Fail("there is no array of any joint beside the time");
    return JoinColumns(source_.name(), time, std::move(columns));
  }

  void AddColumns(const std::vector<std::string>& names, const NpyArray& array, std::size_t samples,
                  const std::string& what, std::map<std::string, std::vector<double>>& columns) {
    if (array.is_text || array.shape != std::vector{samples, names.size()}) {
      Fail("the array of " + what + " is not of " + std::to_string(samples) + " x " +
           std::to_string(names.size()) + " numbers (samples x joints)");
    }
    for (std::size_t k = 0; k < names.size(); ++k) {
      std::vector<double> column(samples);
      for (std::size_t i = 0; i < samples; ++i) column[i] = array.numbers[i * names.size() + k];
      if (!columns.emplace(names[k], std::move(column)).second) {
        Fail("two joints of the name " + Quote(names[k]));
      }
    }
  }

  /// Every list of numbers as long as the time is a column of its own.
  void AddArrays(std::size_t samples, std::map<std::string, std::vector<double>>& columns) {
    const std::map<std::string, std::size_t> entries = entries_;
    for (const auto& [name, i] : entries) {
      const std::vector<std::size_t> wanted = {samples};
      NpyArray array = archive_.Read(i, &wanted);
      if (array.is_text || array.shape != wanted) continue;
      columns.emplace(name, std::move(array.numbers));
      entries_.erase(name);
    }
    for (auto field = fields_.begin(); field != fields_.end();) {
      NpyArray& array = field->second;
      if (array.is_text || array.shape != std::vector{samples}) {
        ++field;
        continue;
      }
      columns.emplace(field->first, std::move(array.numbers));
      field = fields_.erase(field);
    }
  }

  const ByteSource& source_;
  const std::string time_unit_;  ///< given by the user; empty: that of the file, or s
  ZipArchive archive_;
  std::map<std::string, NpyArray> fields_;      ///< of records, that are not used yet, by name
  std::map<std::string, std::size_t> entries_;  ///< arrays that are not read yet, by name
  std::vector<std::string> notes_;
};

}  // namespace

bool IsNpz(std::string_view head) { return head.starts_with("PK\x03\x04"); }

RecordingFile ReadNpz(const ByteSource& source, const ReaderOptions& options) {
  return NpzReader(source, options.time_unit).Read();
}

}  // namespace elastocal
