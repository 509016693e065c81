// Tests that crash, hang and end their process, for tests/support/check_test_main. They run only where FORESIGHT_CRASH
// is set.
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

namespace {

class Crashing : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::getenv("FORESIGHT_CRASH")) GTEST_SKIP() << "crashes; tests/support/check_test_main runs it";
  }
};

TEST_F(Crashing, First) {}
TEST_F(Crashing, Crashes) {
  std::raise(SIGSEGV);
}
TEST_F(Crashing, Ends) {
  std::_Exit(0);
}
TEST_F(Crashing, Hangs) {
  for (;;) ::pause();
}
TEST_F(Crashing, Fails) {
  FAIL() << "as it should";
}
TEST_F(Crashing, Last) {}

class CrashingSetUp : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (std::getenv("FORESIGHT_CRASH")) std::abort();
  }
};

TEST_F(CrashingSetUp, NeverRuns) {}

class AfterAll : public Crashing {};

TEST_F(AfterAll, Last) {}

}  // namespace
