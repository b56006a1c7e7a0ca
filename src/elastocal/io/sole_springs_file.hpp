// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/sole_springs.hpp"
#include "elastocal/files/yaml_value.hpp"

namespace YAML {  // NOLINT(readability-identifier-naming)
class Emitter;
}

namespace elastocal {

/// Adds the list `soles` of a calibration.yaml. Adds nothing if there are no springs.
void EmitSoleSprings(const std::vector<SoleSpring>& springs, YAML::Emitter& yaml);

/// Reads the list `soles` from the mapping of the file; empty if there is none. Throws InputError
/// naming file, line and key.
std::vector<SoleSpring> ReadSoleSprings(const YamlValue& root);

}  // namespace elastocal
