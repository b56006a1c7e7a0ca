// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/cause_picture_json.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "elastocal/pipeline/diagnose.hpp"
#include "elastocal/report/encoding.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegreesARadian = 180.0 / M_PI;

/// A quantity of a picture as people read it.
struct Axis {
  std::string what;
  const char* unit;
  double factor;
};

Axis VariableAxis(const CausePicture& picture, const Correction& correction) {
  const std::string& joint = picture.driver;
  const bool turns = picture.is_angle;
  switch (picture.variable) {
    case CauseVariable::kPosition:
      if (!turns) return {"position of " + joint, "mm", 1e3};
      return {"position of " + joint, "deg", kDegreesARadian};
    case CauseVariable::kLoad:
      return {"load on " + joint, turns ? "N.m" : "N", 1.0};
    case CauseVariable::kApproach:
      return {"direction in which " + joint + " last moved", "", 1.0};
    case CauseVariable::kMoment:
      return {correction.shape == CorrectionShape::kSuspensionMx
                  ? "moment of the weight about x of the root link"
                  : "moment of the weight about y of the root link",
              "N.m", 1.0};
    default:
      return {"time", "h", 1.0};
  }
}

std::string Displaced(const Correction& correction, const std::string& owner) {
  if (correction.joint >= 0) return "displacement of " + owner;
  const std::string axis(1, "xyz"[correction.axis % 3]);
  return (correction.axis < 3 ? "displacement of the root link along "
                              : "rotation of the root link about ") +
         axis;
}

Json Numbers(const Eigen::VectorXd& values, double factor) {
  Json numbers = Json::array();
  for (double value : values) numbers.push_back(Rounded(factor * value));
  return numbers;
}

Json PictureJson(const CauseReport& report, const CausePicture& picture) {
  const Correction& correction = report.corrections[static_cast<std::size_t>(picture.correction)];
  const Axis x = VariableAxis(picture, correction);
  const double y = 1e3;
  Json json;
  json["name"] = picture.finding.cause;
  json["words"] = DescribeCause(report, picture.finding);
  json["p_adjusted"] = picture.finding.p_adjusted;
  json["against"] = x.what;
  json["against_unit"] = x.unit;
  json["displaced"] = Displaced(correction, picture.owner);
  json["unit"] = picture.is_angle ? "mrad" : "mm";
  json["postures"] = picture.postures;
  json["x"] = Numbers(picture.x, x.factor);
  json["y"] = Numbers(picture.y, y);
  json["sd"] = Numbers(picture.sd, y);
  json["curve_x"] = Numbers(picture.curve_x, x.factor);
  json["curve_y"] = Numbers(picture.curve_y, y);
  return json;
}

}  // namespace

Json CausePicturesJson(const CauseReport& report) {
  Json pictures = Json::array();
  for (const CausePicture& picture : report.pictures) {
    pictures.push_back(PictureJson(report, picture));
  }
  return pictures;
}

}  // namespace elastocal
