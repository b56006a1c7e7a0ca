#include "elastocal/io/unknown_column.hpp"

#include "elastocal/io/text.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {

void FailUnknownColumn(const std::string& column, const std::string& place,
                       const std::vector<std::string>& known,
                       const std::filesystem::path& project_file) {
  if (ParseNumber(column)) {
    throw InputError(place + "found the number " + Quote(column) +
                     " in the first row; a header row with the names of the columns was expected");
  }
  throw InputError(place + "unknown column " + Quote(column) +
                   DidYouMean(column.substr(0, 60), known) +
                   " (columns that are not to be read are listed in recording.ignore of " +
                   project_file.string() + ")");
}

}  // namespace elastocal
