// `foresight can` where there is no hardware, and `foresight bench can`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/apps/program.hpp"

namespace foresight {
namespace {

using testing::HasSubstr;

TEST(Can, ScanSaysWhatIsThereAndWhatToType) {
  const Outcome out = run_program({"can", "scan"});
  EXPECT_TRUE(out.exit_code == 0 || out.exit_code == 1) << out.err;
  EXPECT_FALSE(out.out.empty());
  if (out.exit_code == 0) return;
  EXPECT_THAT(out.out, testing::AnyOf(HasSubstr("modprobe"), HasSubstr("ip link set")));
}

TEST(Can, WrongInputIsNamedBeforeAnythingIsOpened) {
  const std::pair<std::vector<std::string>, const char*> cases[] = {
      {{"can", "send", "can0", "123"}, "no # between identifier and data: '123'"},
      {{"can", "send", "can0", "20000040#00"}, "error frames cannot be sent"},
      {{"can", "dump", "can0", "--filter", "580"}, "--filter: '580' has no colon"},
      {{"can", "dump", "can0", "--filter", "580:1FFFFFFF"}, "mixes 11 and 29 bits"},
      {{"can", "dump", "can0", "--count", "nan"}, "--count"},
      {{"can", "replay", "/nowhere.log", "can0"}, "/nowhere.log: cannot be opened"},
  };
  for (const auto& [arguments, problem] : cases) {
    const Outcome out = run_program(arguments);
    EXPECT_EQ(out.exit_code, 2) << problem;
    EXPECT_THAT(out.last_line(), HasSubstr(problem));
  }
}

TEST(Can, BenchMeetsTheLimit) {
  const auto file =
      std::filesystem::temp_directory_path() / ("foresight-bench-can-" + std::to_string(getpid()) + ".json");
  const Outcome out = run_program({"bench", "can", "--json", file.string()});
  EXPECT_EQ(out.exit_code, 0) << out.out;
  const auto all = nlohmann::json::parse(std::ifstream(file));
  std::filesystem::remove(file);
  EXPECT_LT(all["share_of_core_on_full_bus"], 0.05);
  EXPECT_NEAR(all["wire_frames_per_second"]["shortest"], 1e6 / 47, 1);
}

}  // namespace
}  // namespace foresight
