#include "elastocal/robot/error_model.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

using Kind = ParameterKind;

std::vector<int> ActiveJoints(const RobotTree& tree, const std::vector<Marker>& markers) {
  std::set<int> active;
  for (const Marker& marker : markers) {
    for (int joint : JointsToBody(tree, tree.links[marker.link].body)) active.insert(joint);
  }
  return {active.begin(), active.end()};
}

void AddBaseParameters(std::vector<Parameter>& parameters) {
  for (const char* name : {"gamma", "b", "alpha", "d", "theta", "r"}) {
    const bool length = name[1] == '\0';
    parameters.push_back({std::string("waist.T0.") + name, Kind::kBase,
                          length ? ParameterUnit::kMetre : ParameterUnit::kRadian});
  }
}

void AddJointParameters(const RobotTree& tree, int joint, const JointPlacement& placement,
                        std::vector<Parameter>& parameters) {
  const auto add = [&](Kind kind, ParameterUnit unit) {
    parameters.push_back({tree.joints[joint].name + "." + KindName(kind), kind, unit, joint});
  };
  if (placement.general) {
    add(Kind::kGamma, ParameterUnit::kRadian);
    add(Kind::kB, ParameterUnit::kMetre);
  }
  if (placement.parallel) add(Kind::kBeta, ParameterUnit::kRadian);
  add(Kind::kAlpha, ParameterUnit::kRadian);
  add(Kind::kD, ParameterUnit::kMetre);
  add(Kind::kTheta, ParameterUnit::kRadian);
  add(Kind::kR, ParameterUnit::kMetre);
}

void AddMarkerParameters(const std::vector<Marker>& markers, std::vector<Parameter>& parameters) {
  for (std::size_t i = 0; i < markers.size(); ++i) {
    for (const char* coordinate : {"x", "y", "z"}) {
      parameters.push_back({"marker." + markers[i].name + "." + coordinate, Kind::kMarker,
                            ParameterUnit::kMetre, -1, static_cast<int>(i)});
    }
  }
}

void CheckMarkers(const RobotTree& tree, const std::vector<Marker>& markers) {
  std::set<std::string> names;
  for (const Marker& marker : markers) {
    if (!names.insert(marker.name).second) {
      throw std::invalid_argument("two markers are called '" + marker.name + "'");
    }
    if (marker.link < 0 || marker.link >= static_cast<int>(tree.links.size())) {
      throw std::invalid_argument("marker '" + marker.name + "' is on a link that does not exist");
    }
  }
}

/// Gives the model its markers, and the parameters of these and of the joints that move them.
void SetMarkers(ErrorModel& model, std::vector<Marker> markers) {
  CheckMarkers(model.tree, markers);
  model.active_joints = ActiveJoints(model.tree, markers);
  model.parameters.clear();
  AddBaseParameters(model.parameters);
  for (int joint : model.active_joints) {
    AddJointParameters(model.tree, joint, model.placements[joint], model.parameters);
  }
  AddMarkerParameters(markers, model.parameters);
  model.markers = std::move(markers);
}

}  // namespace

ErrorModel MakeErrorModel(RobotTree tree, std::vector<Marker> markers,
                          const PlacementOptions& options) {
  ErrorModel model;
  model.placements = PlaceJoints(tree, options);
  model.tree = std::move(tree);
  SetMarkers(model, std::move(markers));
  return model;
}

ErrorModel SelectMarkers(const ErrorModel& model, const std::vector<std::string>& names) {
  std::vector<Marker> selected;
  std::vector<std::string> known;
  for (const Marker& marker : model.markers) known.push_back(marker.name);
  for (const std::string& name : names) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) {
      throw InputError("no marker '" + name + "'" + DidYouMean(name, known));
    }
    selected.push_back(model.markers[found - known.begin()]);
  }
  ErrorModel result = model;
  SetMarkers(result, std::move(selected));
  return result;
}

}  // namespace elastocal
