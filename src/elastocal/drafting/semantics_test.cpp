// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/semantics.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

TEST(Semantics, OfAnotherRobotAreRefused) {
  const Semantics dog = ParseSemantics(
      "<robot name='dog'><group_state name='home' group='all'><joint name='LF_HAA' value='0.1'/>"
      "</group_state><disable_collisions link1='LF' link2='RF' reason='Never'/></robot>",
      "dog.srdf");
  RobotTree tree;
  tree.links.resize(1);
  tree.links[0].name = "base";
  EXPECT_THROW(CheckBelongs(dog, tree), InputError);
  EXPECT_NO_THROW(CheckBelongs({}, tree)) << "there is none";
  tree.links[0].name = "RF";
  EXPECT_NO_THROW(CheckBelongs(dog, tree));
}

}  // namespace
}  // namespace elastocal
