// SPDX-License-Identifier: Apache-2.0
#include "elastocal/report/run_record.hpp"

#include <cstdint>
#include <fstream>
#include <system_error>

#include <nlohmann/json.hpp>

#include "elastocal/math/input_error.hpp"
#include "elastocal/report/encoding.hpp"
#include "elastocal/report/json_reader.hpp"
#include "elastocal/tables/json_text.hpp"
#include "elastocal/tables/read_file.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kPlain =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=:,+@%";

constexpr std::uintmax_t kLargestInput = std::uintmax_t{4} << 30;  // no recording is larger

}  // namespace

std::vector<InputRecord> RecordInputs(const std::vector<std::filesystem::path>& files) {
  std::vector<InputRecord> records;
  for (const std::filesystem::path& file : files) {
    try {
      if (FileTypeOf(file) != std::filesystem::file_type::regular) continue;
      std::error_code error;
      if (std::filesystem::file_size(file, error) > kLargestInput || error) continue;
      std::ifstream stream(file, std::ios::binary);
      if (!stream) continue;
      std::size_t bytes = 0;
      std::string sum = Sha256(stream, bytes);
      records.push_back({file.string(), bytes, std::move(sum)});
    } catch (const InputError&) {
      continue;  // a file that cannot be read was not used
    }
  }
  return records;
}

std::string QuoteCommandLine(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) {
    if (!line.empty()) line += ' ';
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) {
      line += word;
      continue;
    }
    line += '\'';
    for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += '\'';
  }
  return line;
}

std::string UpdateRuns(const std::string& runs, const RunRecord& record) {
  Json json = Json::object();
  try {
    json = ParseJsonObject("runs.json", runs);
  } catch (const InputError&) {
    // The new result is kept even if the old records cannot be read.
  }
  Json item = {{"command_line", record.command_line},
               {"folder", record.folder},
               {"version", record.version}};
  item["seed"] = record.seed ? Json(*record.seed) : Json(nullptr);
  item["inputs"] = Json::array();
  for (const InputRecord& input : record.inputs) {
    item["inputs"].push_back(
        {{"file", input.file}, {"bytes", input.bytes}, {"sha256", input.sha256}});
  }
  if (record.assumptions) {
    item["accept"] = record.assumptions->accept;
    item["prior"] = record.assumptions->prior;
    item["days"] = record.assumptions->days;
    item["marker_places"] = record.assumptions->marker_places;
  }
  json[record.command] = std::move(item);
  return JsonText(json);
}

}  // namespace elastocal
