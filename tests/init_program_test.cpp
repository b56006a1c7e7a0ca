// SPDX-License-Identifier: Apache-2.0
// The command `init` as its users run it.
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "elastocal/files/output_files.hpp"
#include "tests/run_program.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

TEST(InitProgram, WritesAProjectThatInspectAndDesignTakeAsItIs) {
  const ScratchFolder folder;
  const std::string out = (folder.path() / "arm").string();
  const std::string urdf = SourceFile("tests/robots/arm6.urdf").string();
  const ProgramResult made =
      RunProgram("init " + urdf + " -o " + out + " --json " + out + "/init.json");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(ReadFile(out + "/arm6.urdf"), ReadFile(urdf));
  const auto json = nlohmann::json::parse(ReadFile(out + "/init.json"));
  EXPECT_EQ(json["chains"][0]["tip"], "tool");
  EXPECT_FALSE(json["stands"]);
#ifdef ELASTOCAL_HAS_PAGE
  // The page shows the draft. Made again, it shows what somebody has corrected in the draft.
  const auto radius_on_page = [&] {
    const std::string page = ReadFile(out + "/report.html");
    const std::string key = "\"radius_m\":";
    return std::stod(page.substr(page.find(key) + key.size(), 20));
  };
  EXPECT_NE(ReadFile(out + "/report.html").find("\"position_m\":"), std::string::npos);
  std::string yaml = ReadFile(out + "/project.yaml");
  const std::string key = "radius_mm: ";
  const std::size_t at = yaml.find(key) + key.size();
  yaml.replace(at, yaml.find('}', at) - at, "77");
  EXPECT_NE(radius_on_page(), 0.077);
  std::ofstream(out + "/project.yaml") << yaml;
  EXPECT_EQ(RunProgram("report " + out).exit_code, 0);
  EXPECT_EQ(radius_on_page(), 0.077);
#endif
  const ProgramResult inspected = RunProgram("inspect " + out + "/project.yaml");
  EXPECT_EQ(inspected.exit_code, 0) << inspected.err;
  const std::string postures = out + "/postures.yaml", motion = out + "/motion.csv";
  const ProgramResult designed =
      RunProgram("design " + out + "/project.yaml --count 4 --no-certificate -o " + postures);
  EXPECT_EQ(designed.exit_code, 0) << designed.err;
  const ProgramResult planned =
      RunProgram("plan " + out + "/project.yaml --postures " + postures + " -o " + motion);
  EXPECT_EQ(planned.exit_code, 0) << planned.err;
  EXPECT_NE(ReadFile(motion).find(",none,"), std::string::npos);  // the root link is held
}

TEST(InitProgram, FindsMeshesInPackagesThatAreNamed) {
  const ScratchFolder folder;
  std::string urdf = ReadFile(SourceFile("tests/robots/arm6.urdf"));
  urdf.insert(urdf.find('>', urdf.find("<link name=\"tool\"")) + 1,
              "<visual><geometry><mesh filename=\"package://tool/t.obj\"/></geometry></visual>");
  const std::string arm = folder.Write("arm.urdf", urdf);
  std::filesystem::create_directory(folder.path() / "elsewhere");
  folder.Write("elsewhere/t.obj",
               "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  const std::string out = (folder.path() / "out").string();
  const ProgramResult missing = RunProgram("init " + arm + " -o " + out);
  EXPECT_EQ(missing.exit_code, 0) << missing.err;
  EXPECT_NE(missing.err.find("--package tool=DIR"), std::string::npos) << missing.err;
  const std::string package = " --package tool=" + (folder.path() / "elsewhere").string();
  const ProgramResult found = RunProgram("init" + package + " " + arm + " --force -o " + out);
  EXPECT_EQ(found.exit_code, 0) << found.err;
  EXPECT_NE(found.out.find("1 meshes read"), std::string::npos) << found.out;
  EXPECT_EQ(found.err.find("missing"), std::string::npos) << found.err;
}

TEST(InitProgram, ReplacesNothingUnasked) {
  const ScratchFolder folder;
  const std::string urdf = SourceFile("tests/robots/arm6.urdf").string();
  const std::string mine = folder.Write("project.yaml", "my own work");
  const ProgramResult refused = RunProgram("init " + urdf + " -o " + folder.path().string());
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.err.find("--force"), std::string::npos) << refused.err;
  EXPECT_EQ(ReadFile(mine), "my own work");
  EXPECT_EQ(RunProgram("init " + urdf + " --force -o " + folder.path().string()).exit_code, 0);
  EXPECT_TRUE(ReadFile(mine).starts_with("# Drafted by elastocal init."));
}

TEST(InitProgram, BadInputIsNamedAndNothingIsWritten) {
  const ScratchFolder folder;
  const std::string out = (folder.path() / "out").string();
  const std::string still = folder.Write("still.urdf", "<robot name='r'><link name='a'/></robot>");
  const std::string bad_srdf = folder.Write("bad.srdf", "<robot name='r'><group/></robot>");
  const std::string urdf = SourceFile("tests/robots/arm6.urdf").string();
  for (const auto& [words, part] : {std::pair<std::string, std::string>{still, "no movable joint"},
                                    {urdf + " --srdf " + bad_srdf, "bad.srdf:1"},
                                    {urdf + " --srdf none.srdf", "none.srdf"},
                                    {urdf + " --package arm", "NAME=DIR"},
                                    {urdf + " --package arm=nowhere", "no folder 'nowhere'"},
                                    {folder.path().string(), "folder"},
                                    {"none.urdf", "none.urdf"}}) {
    const ProgramResult result = RunProgram("init " + words + " -o " + out);
    EXPECT_EQ(result.exit_code, 3) << words;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(out)) << words;
  }
}

}  // namespace
}  // namespace elastocal
