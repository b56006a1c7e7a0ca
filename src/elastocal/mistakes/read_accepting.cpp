// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/read_accepting.hpp"

#include "elastocal/mistakes/recording_mistakes.hpp"

namespace elastocal {

AcceptedMeasurements ReadAccepting(Project& project,
                                   const std::vector<std::filesystem::path>& recordings,
                                   const std::vector<std::string>& accepted, ReadFor purpose) {
  project.measurement.accepted = accepted;
  AcceptedMeasurements read{ReadMeasurements(project, recordings, purpose), {}};
  read.undone = AcceptMistakes(project, accepted, read.measured);
  return read;
}

}  // namespace elastocal
