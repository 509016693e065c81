#include "gl/kept_programs.hpp"

#include <gtest/gtest.h>

#include "gl/program.hpp"
#include "tests/support/headless_test.hpp"

namespace foresight::gl::kept_programs_test {
namespace {

using KeptProgramsTest = HeadlessTest;

const ShaderSources kSources{{"store.comp",
                              "layout(local_size_x = 1) in;\n"
                              "layout(binding = 0, r32i) uniform writeonly iimage2D place;\n"
                              "void main() { imageStore(place, ivec2(0), ivec4(VALUE)); }\n"}};

Program storing(int value) {
  return Program::compute(kSources, "store.comp", {"VALUE " + std::to_string(value)});
}

// Passes are destroyed in the opposite order of their making: each gets the program that it had before.
TEST_F(KeptProgramsTest, WhoBeginsAnewHasThePrograms) {
  KeptPrograms store;
  const KeptPrograms::Use use(store);
  GLuint first = 0, second = 0, other = 0;
  {
    const Program a = storing(1), b = storing(1), c = storing(2);
    first = a.name();
    second = b.name();
    other = c.name();
    EXPECT_NE(first, second) << "two at a time are two";
  }
  EXPECT_TRUE(glIsProgram(first));
  const Program c = storing(2), a = storing(1), b = storing(1);
  EXPECT_EQ(a.name(), first);
  EXPECT_EQ(b.name(), second);
  EXPECT_EQ(c.name(), other);
  const Program third = storing(1);
  EXPECT_TRUE(third.name() != first && third.name() != second) << "there were two";
}

TEST_F(KeptProgramsTest, NoneAreKeptOutsideOfItsUse) {
  KeptPrograms store;
  GLuint before = 0, within = 0, kept = 0;
  {
    const Program made_before = storing(1);
    before = made_before.name();
    std::optional<Program> made_within;
    {
      const KeptPrograms::Use use(store);
      made_within = storing(1);
      within = made_within->name();
      kept = storing(2).name();
    }
  }
  EXPECT_FALSE(glIsProgram(before));
  EXPECT_FALSE(glIsProgram(within)) << "nobody would ask for it";
  EXPECT_TRUE(glIsProgram(kept));
  EXPECT_NE(storing(2).name(), kept) << "not in use";
  const KeptPrograms::Use again(store);
  EXPECT_EQ(storing(2).name(), kept);
}

TEST_F(KeptProgramsTest, GoWithTheStore) {
  GLuint name = 0;
  {
    KeptPrograms store;
    const KeptPrograms::Use use(store);
    name = storing(1).name();
    EXPECT_TRUE(glIsProgram(name));
  }
  EXPECT_FALSE(glIsProgram(name));
}

// A session within a session.
TEST_F(KeptProgramsTest, TheNewestStoreInUseCounts) {
  KeptPrograms outer, inner;
  const KeptPrograms::Use use(outer);
  const GLuint of_outer = storing(1).name();
  {
    const KeptPrograms::Use shorter(inner);
    EXPECT_EQ(KeptPrograms::in_use(), &inner);
    EXPECT_NE(storing(1).name(), of_outer);
  }
  EXPECT_EQ(storing(1).name(), of_outer);
}

}  // namespace
}  // namespace foresight::gl::kept_programs_test
