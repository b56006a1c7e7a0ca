#include <iostream>

#include "elastocal/io/urdf_reader.hpp"

namespace {

constexpr const char* kUrdf = R"(<robot name="arm">
  <link name="base"/> <link name="upper"/> <link name="fore"/>
  <joint name="shoulder" type="continuous">
    <parent link="base"/> <child link="upper"/> <axis xyz="0 0 1"/>
  </joint>
  <joint name="elbow" type="continuous">
    <parent link="upper"/> <child link="fore"/> <axis xyz="0 1 0"/> <origin xyz="0.3 0 0"/>
  </joint>
</robot>)";

}  // namespace

int main() {
  const elastocal::RobotTree tree = elastocal::ParseUrdf(kUrdf, "the text in all_layers.cpp");
  std::cout << tree.joints.size() << " joints\n";
  return tree.joints.size() == 2 ? 0 : 1;
}
