// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "elastocal/planning/curves_file.hpp"
#include "elastocal/planning/design_postures.hpp"
#include "elastocal/tables/json_text.hpp"
#include "elastocal/tables/table_writer.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

/// Name of a criterion: "O1" to "O5".
std::string CriterionName(Criterion criterion) {
  return "O" + std::to_string(static_cast<int>(criterion) + 1);
}

/// Name of a file beside another: "postures.yaml" -> "postures_summary.json".
std::filesystem::path Beside(const std::filesystem::path& output, const std::string& ending) {
  return output.parent_path() / (output.stem().string() + ending);
}

std::string FormatCurvesTable(const std::vector<CurvePoint>& points, std::uint64_t seed) {
  std::string text = "algorithm,chain,seed,postures,o1\n";
  for (const CurvePoint& point : points) {
    text += fmt::format("{},{},{},{},{:.9g}\n", AlgorithmName(point.algorithm),
                        MakeCell(point.chain), seed, point.postures, point.index);
  }
  return text;
}

std::string DrawCurves(const std::vector<CurvePoint>& points, Criterion criterion) {
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
  return FormatCurvesSvg(curves, "number of postures", CriterionName(criterion));
}

Json ChainJson(const DesignedPostures& designed) {
  const ChainDesign& design = designed.design;
  return {{"chain", design.setup.name},
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
          {"time_s", designed.seconds},
          {"mirror_of", design.mirrored_from},
          {"sizes", design.sizes},
          {"indices", design.indices},
          {"notes", design.notes}};
}

}  // namespace

const char* StatusText(DesignResult::Status status) {
  switch (status) {
    case DesignResult::Status::kPlateau:
      return "plateau";
    case DesignResult::Status::kMaxPostures:
      return "number";
    case DesignResult::Status::kNoPosture:
      return "no feasible posture";
    case DesignResult::Status::kRankDeficient:
      break;
  }
  return "rank deficient";
}

DesignFiles::DesignFiles(const std::filesystem::path& output)
    : postures(output),
      summary(Beside(output, "_summary.json")),
      curves(Beside(output, "_curves.csv")),
      picture(Beside(output, "_curves.svg")) {}

void DesignFiles::Declare(OutputSet& outputs) const {
  outputs.Declare(postures, "robot: ");
  outputs.Declare(summary, "{");
  outputs.Declare(curves, "algorithm,");
  outputs.Declare(picture, "<svg");
}

std::string FormatDesignSummary(const Project& project, const PostureDesign& design,
                                const PostureDesignOptions& options) {
  Json chains = Json::array();
  for (const DesignedPostures& designed : design.chains) chains.push_back(ChainJson(designed));
  const Json json = {{"robot", project.tree.name},
                     {"criterion", CriterionName(options.design.criterion)},
                     {"seed", options.design.seed},
                     {"postures", design.posture_count()},
                     {"chains", chains}};
  return JsonText(json);
}

void SetDesignFiles(const DesignFiles& files, const Project& project, const PostureDesign& design,
                    const PostureDesignOptions& options, OutputSet& outputs) {
  outputs.Set(files.postures, FormatPostureFile(project.tree, design.postures()));
  outputs.Set(files.summary, FormatDesignSummary(project, design, options));
  outputs.Set(files.curves, FormatCurvesTable(design.curves, options.design.seed));
  outputs.Set(files.picture, DrawCurves(design.curves, options.design.criterion));
}

}  // namespace elastocal
