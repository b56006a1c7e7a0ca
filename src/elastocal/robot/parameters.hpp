#pragma once

#include <string>
#include <vector>

namespace elastocal {

/// What an error parameter is. Angles in rad, lengths in m; the kinds of eq. 1 and, for the first
/// joint after the waist and after a branch, `kGamma` and `kB` (see placement.hpp).
enum class ParameterKind { kTheta, kR, kD, kB, kAlpha, kBeta, kGamma, kBase, kMarker };
inline constexpr int kParameterKindCount = 9;

enum class ParameterUnit { kRadian, kMetre };

/// One entry of the vector of errors: a deviation from the nominal model, zero at nominal.
struct Parameter {
  /// `<joint>.theta|r|d|b|alpha|beta|gamma`, `waist.T0.gamma|b|alpha|d|theta|r` or
  /// `marker.<marker>.x|y|z` (in the frame of the link that carries the marker).
  std::string name;
  ParameterKind kind;
  ParameterUnit unit;
  int joint = -1;   ///< of the robot tree, for joint parameters
  int marker = -1;  ///< of the error model, for marker positions
};

/// Name of a kind as it appears in names and settings: theta, r, d, b, alpha, beta, gamma, T0,
/// marker.
const char* KindName(ParameterKind kind);

/// Whether a kind of joint parameter is an angle: theta, alpha, beta, gamma.
bool IsAngle(ParameterKind kind);

/// Whether the parameter belongs to the experiment (where the waist and the markers are), not to
/// the robot: fitted anew for every recording, never deployed.
bool IsExternal(ParameterKind kind);

/// Index of the parameter called `name`. Throws InputError with the nearest known name.
int FindParameter(const std::vector<Parameter>& parameters, const std::string& name);

/// Indices, ascending, of the parameters whose names match any of the patterns; `*` stands for any
/// run of characters. A pattern may match nothing: it may concern a part that was not recorded.
std::vector<int> MatchParameters(const std::vector<Parameter>& parameters,
                                 const std::vector<std::string>& patterns);

/// Throws InputError, with the nearest known name, for a pattern that matches nothing.
void CheckPatterns(const std::vector<Parameter>& parameters,
                   const std::vector<std::string>& patterns);

}  // namespace elastocal
