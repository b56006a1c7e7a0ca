// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/cause_picture_json.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "elastocal/pipeline/diagnose.hpp"
#include "elastocal/report/encoding.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegreesARadian = 180.0 / M_PI;

/// An axis of a picture: its quantity with the unit that is shown to users.
struct Axis {
  std::string what;
  const char* unit;
  double factor;
};

/// Unit of a cause that loads joints.
std::string UnitOfLoad(const Correction& correction) {
  const std::string link = correction.name.substr(0, correction.name.rfind('.'));
  const std::string axis(1, "xyz"[std::max(0, correction.axis)]);
  switch (correction.shape) {
    case CorrectionShape::kMass:
      return "1 kg of " + link;
    case CorrectionShape::kFirstMoment:
      return "1 kg.m along " + axis + " of " + link;
    default:
      return "gravity turned by 1 rad about " + axis + " of the root link";
  }
}

Axis VariableAxis(const CausePicture& picture, const Correction& correction) {
  const std::string& joint = picture.driver;
  const bool turns = picture.driver_turns;
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
    case CauseVariable::kAddedLoad:
      return {"load on " + joint + " by " + UnitOfLoad(correction), turns ? "N.m" : "N", 1.0};
    default:
      return {"time", "h", 1.0};
  }
}

std::string Displaced(const Correction& correction, const CausePicture& picture) {
  if (correction.joint >= 0) return "displacement of " + picture.owner;
  if (picture.variable == CauseVariable::kAddedLoad) {
    return std::string(picture.axis == 2 ? "deflection of " : "bending of ") + picture.owner;
  }
  const std::string axis(1, "xyz"[correction.axis % 3]);
  if (correction.marker >= 0) {
    return "displacement of marker " + picture.owner + " along " + axis + " of its link";
  }
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
  json["displaced"] = Displaced(correction, picture);
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
