// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/calibration/sole_springs.hpp"
#include "elastocal/files/yaml_value.hpp"

namespace YAML {  // NOLINT(readability-identifier-naming)
class Emitter;
}

namespace elastocal {

/// Adds the list `soles` of a calibration.yaml: of the feet that a load told anything of. Nothing
/// where there are none.
void EmitSoleSprings(const std::vector<SoleSpring>& springs, YAML::Emitter& yaml);

/// The same list, read from the file's mapping; empty where it has none. Throws InputError naming
/// file, line and key.
std::vector<SoleSpring> ReadSoleSprings(const YamlValue& root);

}  // namespace elastocal
