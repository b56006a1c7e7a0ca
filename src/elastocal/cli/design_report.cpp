#include "elastocal/cli/design_report.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "elastocal/cli/text_table.hpp"
#include "elastocal/io/curves_file.hpp"
#include "elastocal/tables/table_writer.hpp"

namespace elastocal::cli {
namespace {

using Json = nlohmann::ordered_json;

const char* StatusText(DesignResult::Status status) {
  switch (status) {
    case DesignResult::Status::kPlateau:
      return "plateau";
    case DesignResult::Status::kMaxPostures:
      return "number";
    case DesignResult::Status::kNoPosture:
      return "no feasible posture";
    default:
      return "rank deficient";
  }
}

}  // namespace

std::string DesignTable(const std::vector<Designed>& designed) {
  TextTable table(
      {"chain", "parameters", "postures", "ended by", "O", "efficiency %", "yield %", "time s"});
  for (const auto& [design, seconds] : designed) {
    table.Add(
        {design.setup.name, std::to_string(design.parameter_count),
         std::to_string(design.postures.size()),
         design.mirrored_from.empty() ? StatusText(design.status)
                                      : "mirror of " + design.mirrored_from,
         fmt::format("{:.4f}", design.index),
         design.certificate.bound > 0.0 ? fmt::format("{:.1f}", 100.0 * design.Efficiency()) : "",
         design.sampling.tries > 0 ? fmt::format("{:.0f}", 100.0 * design.sampling.Yield()) : "",
         fmt::format("{:.2f}", seconds)});
  }
  return table.Render();
}

Json DesignJson(const std::vector<Designed>& designed, const std::string& robot,
                const std::string& criterion, std::uint64_t seed) {
  Json chains = Json::array();
  std::size_t total = 0;
  for (const auto& [design, seconds] : designed) {
    total += design.postures.size();
    Json chain = {{"chain", design.setup.name},
                  {"parameters", design.parameter_count},
                  {"postures", design.postures.size()},
                  {"ended_by", StatusText(design.status)},
                  {"index", design.index},
                  {"bound", design.certificate.bound},
                  {"efficiency", design.Efficiency()},
                  {"random_postures",
                   {{"tries", design.sampling.tries},
                    {"feasible_at_once", design.sampling.feasible_at_once},
                    {"found", design.sampling.found}}},
                  {"time_s", seconds},
                  {"mirror_of", design.mirrored_from},
                  {"sizes", design.sizes},
                  {"indices", design.indices},
                  {"notes", design.notes}};
    chains.push_back(std::move(chain));
  }
  return {{"robot", robot},
          {"criterion", criterion},
          {"seed", seed},
          {"postures", total},
          {"chains", chains}};
}

std::string CurvesCsv(const std::vector<CurvePoint>& points, std::uint64_t seed) {
  std::string text = "algorithm,chain,seed,postures,o1\n";
  for (const CurvePoint& point : points) {
    text += fmt::format("{},{},{},{},{:.9g}\n", AlgorithmName(point.algorithm),
                        MakeCell(point.chain), seed, point.postures, point.index);
  }
  return text;
}

std::string CurvesSvg(const std::vector<CurvePoint>& points, const std::string& criterion) {
  std::vector<Curve> curves;
  for (const CurvePoint& point : points) {
    auto found = std::find_if(curves.begin(), curves.end(), [&](const Curve& curve) {
      return curve.name == AlgorithmName(point.algorithm) && curve.panel == point.chain;
    });
    if (found == curves.end()) {
      curves.push_back({AlgorithmName(point.algorithm), point.chain, {}, {}});
      found = curves.end() - 1;
    }
    found->x.push_back(point.postures);
    found->y.push_back(point.index);
  }
  return FormatCurvesSvg(curves, "number of postures", criterion);
}

}  // namespace elastocal::cli
