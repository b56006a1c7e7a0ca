// What the readers of results make of damaged ones, and what the writers do not replace.

#include <functional>

#include <gtest/gtest.h>

#include "elastocal/io/output_files.hpp"
#include "tests/program_fixture.hpp"

namespace elastocal {
namespace {

void ExpectBad(const ProgramResult& result, std::initializer_list<std::string> parts) {
  EXPECT_EQ(result.exit_code, 3) << result.out << result.err;
  for (const std::string& part : parts) {
    EXPECT_NE(result.err.find(part), std::string::npos) << part << " not in: " << result.err;
  }
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

// Alone, without the folder that it was in: nothing but the file itself tells.
TEST_F(Program, ADamagedCalibrationIsRefusedByAllWhoReadIt) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const std::string good = ReadFile(out_ + "/calibration.yaml");
  const auto refused = [&](const std::string& text, std::initializer_list<std::string> parts) {
    std::filesystem::create_directories(scratch_.path() / "damaged");
    const std::string file = scratch_.Write("damaged/calibration.yaml", text);
    ExpectBad(RunProgram("validate " + project_ + " --recording " + recording_ + " --calibration " +
                         file),
              parts);
    ExpectBad(RunProgram("compare " + file + " " + out_), parts);
    scratch_.Write("damaged/summary.json", "{}");
    ExpectBad(RunProgram("report " + (scratch_.path() / "damaged").string()), parts);
  };
  const std::size_t last = good.rfind("\n  - {name");
  refused(good.substr(0, last + 1), {"calibration.yaml:", "parameters", "cut"});
  const std::size_t elbow = good.find("\n  - {name: elbow_joint.d,");
  std::string missing = good;
  missing.erase(elbow, good.find('\n', elbow + 1) - elbow);
  refused(missing, {"calibration.yaml:", "parameters", "cut"});
  refused(good.substr(0, good.find("\n  - {name")) + "\n", {"calibration.yaml:", "no parameter"});
  refused("", {"calibration.yaml"});
  const std::string theta = "elbow_joint.theta, unit: ";
  refused(Replaced(good, theta + "rad", theta + "m"), {"calibration.yaml:", "unit", "'m'", "rad"});
  const std::size_t value = good.find("value: ", good.find(theta)) + 7;
  std::string degrees = good;
  degrees.replace(value, good.find(',', value) - value, "17.5");
  refused(degrees, {"calibration.yaml:", "value", "17.5"});
}

TEST_F(Program, ACalibrationOfUnknownJointsIsNotValidated) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const std::string good = ReadFile(out_ + "/calibration.yaml");
  const auto refused = [&](const std::string& text, std::initializer_list<std::string> parts) {
    ExpectBad(RunProgram("validate " + project_ + " --recording " + recording_ + " --calibration " +
                         scratch_.Write("changed.yaml", text)),
              parts);
  };
  refused(Replaced(good, "name: elbow_joint.d", "name: elbow_joit.d"),
          {"changed.yaml:", "elbow_joit", "did you mean 'elbow_joint'"});
  // Without the count that newer files have, a gap is still noticed.
  std::string gap = good;
  gap.erase(gap.find("parameter_count"),
            gap.find('\n', gap.find("parameter_count")) - gap.find("parameter_count") + 1);
  const std::size_t elbow = gap.find("\n  - {name: elbow_joint.d,");
  gap.erase(elbow, gap.find('\n', elbow + 1) - elbow);
  refused(gap, {"changed.yaml", "elbow_joint.d"});
}

}  // namespace
}  // namespace elastocal
