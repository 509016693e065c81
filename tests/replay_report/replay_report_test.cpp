#include "apps/replay_report/replay_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/atomic_file.hpp"
#include "common/error.hpp"
#include "tests/replay_report/example_run.hpp"

namespace foresight::replay_report_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "foresight_report_XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~Folder() { fs::remove_all(path_); }
  fs::path operator/(const std::string& name) const { return path_ / name; }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(path_), fs::directory_iterator()));
  }

 private:
  fs::path path_;
};

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Statistic, InterpolatesBetweenRanksAndSkipsWhatIsNotFinite) {
  const Statistic s = statistic_of({4, NAN, 1, 3, INFINITY, 2});
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.min, 1);
  EXPECT_DOUBLE_EQ(s.max, 4);
  EXPECT_DOUBLE_EQ(s.p99, 3.97);
  EXPECT_TRUE(std::isnan(statistic_of({NAN}).mean));
  EXPECT_DOUBLE_EQ(statistic_of({7}).p99, 7);
}

TEST(Summary, CountsOnlyTextureStagesAsCostOfAnImage) {
  RunRecord run;
  run.texels = 100;
  for (int i = 0; i < 2; ++i) {
    FrameRecord f;
    f.stages = {{"extract", 30, 1.0, StagePart::texture}, {"view", 50, {}, StagePart::view}};
    if (i == 1) f.stages.push_back({"fill", 20, {}, StagePart::texture});
    f.texture_bytes_used = i == 0 ? 900 : 800;
    f.predicted.psnr_db = i == 0 ? 20 : 10;
    run.frames.push_back(f);
  }
  FrameRecord dropped;
  dropped.dropped = true;
  dropped.predicted.psnr_db = 99;
  run.frames.push_back(dropped);
  const Summary s = summarise(run);
  EXPECT_EQ(s.frames, 2u);
  EXPECT_EQ(s.dropped_frames, 1u);
  EXPECT_DOUBLE_EQ(s.predicted.psnr_db.mean, 15);
  EXPECT_DOUBLE_EQ(s.texture_cpu_ms, 40) << "a frame without the stage counts as 0";
  EXPECT_DOUBLE_EQ(s.images_per_core_second, 25);
  EXPECT_DOUBLE_EQ(s.texture_gpu_ms, 1);
  EXPECT_DOUBLE_EQ(s.bytes_per_texel, 9);
  ASSERT_EQ(s.stages.size(), 3u);
  EXPECT_EQ(s.stages[2].name, "fill");
  EXPECT_DOUBLE_EQ(s.stages[2].cpu_ms, 10);
}

TEST(Summary, OfAnEmptyRunIsValid) {
  const auto json = nlohmann::json::parse(to_json(RunRecord{}).dump());
  EXPECT_EQ(json["summary"]["frames"], 0);
  EXPECT_TRUE(json["summary"]["predicted"]["psnr_db"]["mean"].is_null());
  EXPECT_TRUE(json["summary"]["images_per_core_second"].is_null());
  EXPECT_TRUE(json["frames"].is_array());
}

TEST(JsonReport, RoundTripsWithNullForWhatIsNotANumber) {
  RunRecord run = example_run(3);
  run.complete = false;
  run.frames[1].predicted.ssim.reset();
  run.frames[1].delayed.psnr_db = NAN;
  run.frames[2].arrival_to_publish_ms = INFINITY;
  const Folder folder;
  write_json_report(run, folder / "report.json");
  const auto json = nlohmann::ordered_json::parse(read(folder / "report.json"));
  EXPECT_EQ(json["schema_version"], 1);
  EXPECT_EQ(json["complete"], false);
  EXPECT_EQ(json["run"]["name"], run.run);
  EXPECT_EQ(json["options"].dump(), R"({"delay_frames":6,"margin_px":3.0,"real_time":false,"scene":"scene.ply"})");
  EXPECT_DOUBLE_EQ(json["frames"][0]["predicted"]["psnr_db"], *run.frames[0].predicted.psnr_db);
  EXPECT_TRUE(json["frames"][1]["predicted"]["ssim"].is_null());
  EXPECT_TRUE(json["frames"][1]["delayed"]["psnr_db"].is_null());
  EXPECT_TRUE(json["frames"][2]["arrival_to_publish_ms"].is_null());
  EXPECT_TRUE(json["frames"][0]["stages"][4]["gpu_ms"].is_null());
  EXPECT_EQ(json["frames"][0]["stages"][0]["part"], "texture");
  EXPECT_EQ(json.dump(), to_json(run).dump()) << "the order of keys is stable";
}

TEST(JsonReport, SurvivesNamesThatAreNoText) {
  RunRecord run;
  run.run = "bad\xff\xfename";
  const Folder folder;
  write_json_report(run, folder / "report.json");
  EXPECT_NO_THROW(nlohmann::json::parse(read(folder / "report.json")));
}

TEST(AtomicFile, ReplacesAndLeavesNothingElse) {
  const Folder folder;
  write_file_atomically(folder / "a", "one");
  fs::create_symlink(folder / "a", folder / "link");
  write_file_atomically(folder / "link", std::string(100'000, 'x'));
  EXPECT_EQ(read(folder / "a").size(), 100'000u) << "a symbolic link is followed";
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(folder.files(), 2u);
}

TEST(AtomicFile, FilesThatBelongTogetherAreAllNewOrAllOld) {
  const Folder folder;
  write_files_atomically(std::vector<FileContent>{{folder / "a", "old a"}, {folder / "b", "old b"}});
  EXPECT_THROW(write_files_atomically(std::vector<FileContent>{{folder / "a", "new"}, {"/dev/full", "x"}}),
               RuntimeFailure);
  EXPECT_THROW(write_files_atomically(std::vector<FileContent>{{folder / "c", "new"}, {folder / "missing/d", "x"}}),
               RuntimeFailure);
  EXPECT_EQ(read(folder / "a") + read(folder / "b"), "old aold b");
  EXPECT_EQ(folder.files(), 2u);
  write_files_atomically(std::vector<FileContent>{{folder / "a", "1"}, {folder / "b", "2"}});
  EXPECT_EQ(read(folder / "a") + read(folder / "b"), "12");
  EXPECT_EQ(folder.files(), 2u);
}

TEST(AtomicFile, FailureNamesFileAndCureAndKeepsTheOldContent) {
  const Folder folder;
  try {
    write_file_atomically(folder / "missing/report.json", "x");
    FAIL();
  } catch (const RuntimeFailure& e) {
    EXPECT_THAT(e.what(),
                AllOf(HasSubstr("missing/report.json"), HasSubstr("No such file"), HasSubstr("; name a file")));
  }
  EXPECT_THROW(write_file_atomically(folder / "", "x"), RuntimeFailure) << "a folder is no file";
  try {
    write_file_atomically("/dev/full", "x");
    FAIL();
  } catch (const RuntimeFailure& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("/dev/full"), HasSubstr("free some disk space")));
  }
  EXPECT_EQ(folder.files(), 0u);
}

}  // namespace
}  // namespace foresight::replay_report_test
