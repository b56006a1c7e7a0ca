#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "elastocal/posture/design.hpp"

namespace elastocal::cli {

/// A designed chain with how long it took.
struct Designed {
  ChainDesign design;
  double seconds = 0.0;
};

/// One row a chain.
std::string DesignTable(const std::vector<Designed>& designed);

/// postures_summary.json (docs/formats.md, Postures).
nlohmann::ordered_json DesignJson(const std::vector<Designed>& designed, const std::string& robot,
                                  const std::string& criterion, std::uint64_t seed);

/// The index against the number of postures, by chain and algorithm: one row a point, and drawn.
std::string CurvesCsv(const std::vector<CurvePoint>& points, std::uint64_t seed);
std::string CurvesSvg(const std::vector<CurvePoint>& points, const std::string& criterion);

}  // namespace elastocal::cli
