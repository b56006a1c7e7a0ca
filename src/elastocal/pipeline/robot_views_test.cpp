// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/robot_views.hpp"

#include <filesystem>

#include <gtest/gtest.h>
#include <unistd.h>

#include "elastocal/files/output_files.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

/// Makes the process a common user while it lives, who can read only what everybody can; root can
/// read all files.
class CommonUser {
 public:
  CommonUser() : was_root_(geteuid() == 0 && seteuid(65534) == 0) {}
  ~CommonUser() {
    if (was_root_ && seteuid(0) != 0) ADD_FAILURE() << "cannot become root again";
  }
  CommonUser(const CommonUser&) = delete;
  CommonUser& operator=(const CommonUser&) = delete;

 private:
  bool was_root_;
};

TEST(RobotViews, AMeshThatCannotBeReadIsPassedOver) {
  const ScratchFolder scratch;
  constexpr auto kEveryone = static_cast<fs::perms>(0755);
  fs::permissions(scratch.path(), kEveryone);
  std::string urdf = ReadFile(SourceFile("tests/robots/arm6.urdf"));
  urdf.insert(urdf.rfind("</robot>"), R"(<!-- filename="fine.stl" filename="secret.stl" -->)");
  scratch.Write("arm6.urdf", urdf);
  scratch.Write("fine.stl", "abc");
  fs::permissions(scratch.Write("secret.stl", "abc"), fs::perms::none);
  const Project project = ReadProject(
      scratch.Write("project.yaml", ReadFile(SourceFile("tests/robots/arm6_project.yaml"))));
  const CommonUser user;
  std::vector<std::string> warnings;
  const RobotView view = MakeRobotView(project, warnings);
  EXPECT_EQ(view.meshes.size(), 1u);
  EXPECT_TRUE(view.meshes.contains("fine.stl"));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("secret.stl"), std::string::npos) << warnings[0];
}

}  // namespace
}  // namespace elastocal
