// What the machine cannot do ends the program with exit code 1 and says so.
#include <sys/mount.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <random>
#include <thread>

#include "tests/apps/operator_window.hpp"
#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"

namespace foresight::failure_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class Failure : public testing::Test {
 protected:
  void expect_refused(const Outcome& outcome, const std::string& what, const std::string& cure) const {
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.last_line(),
                AllOf(testing::StartsWith("foresight: "), HasSubstr(what), HasSubstr("; "), HasSubstr(cure)));
  }

  TempFolder out_;
};

TEST_F(Failure, AnOldOpenGlIsNamed) {
  const SmallRun run;
  const Outcome outcome =
      run_program({"replay", run.path(), "--out", out_ / "out"}, {{{"MESA_GL_VERSION_OVERRIDE", "3.3"}}});
  if (outcome.exit_code == 0) GTEST_SKIP() << "this driver cannot be told to be old";
  expect_refused(outcome, "OpenGL 3.3", "install");
  EXPECT_THAT(outcome.last_line(), HasSubstr("OpenGL 4.5"));
  EXPECT_TRUE(fs::is_empty(out_.path()));
}

TEST_F(Failure, NoOpenGlAtAllIsNamed) {
  const SmallRun run;
  const Outcome outcome =
      run_program({"replay", run.path(), "--out", out_ / "out"}, {{{"__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere"}}});
  if (outcome.exit_code == 0) GTEST_SKIP() << "EGL is not chosen through GLVND here";
  expect_refused(outcome, "no OpenGL 4.5", "install");
  EXPECT_TRUE(fs::is_empty(out_.path()));
}

TEST_F(Failure, AWindowNeedsADisplay) {
  const SmallRun run;
  const Outcome outcome = run_program({"replay", run.path(), "--window", "--out", out_ / "out"},
                                      {{{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}}});
  expect_refused(outcome, "", "leave out --window");
  EXPECT_TRUE(fs::is_empty(out_.path()));
}

TEST_F(Failure, AWindowThatAnotherProgramDestroysIsNamed) {
  for (const char* program : {"Xvfb", "xdotool"})
    if (!there_is(program)) GTEST_SKIP() << "no " << program << " here; scripts/setup installs it";
  const VirtualScreen screen;
  ASSERT_NE(screen.name(), "") << "Xvfb does not start";
  Program program({"rig", "view", (source_folder() / "configs/minerva.yaml").string()},
                  {.environment = {{"DISPLAY", screen.name()}, {"WAYLAND_DISPLAY", ""}}});
  ASSERT_TRUE(comes_true(
      [&] { return screen.input("search --onlyvisible --name Foresight windowclose") || !program.running(); }));
  expect_refused(program.wait(), "another program has destroyed the window", "start again");
}

TEST_F(Failure, ACrashTellsWhereItWasAndStillIsOne) {
  for (const auto& [signal, words] : {std::pair{SIGSEGV, "Segmentation fault"}, {SIGABRT, "Aborted"}}) {
    Program program({"robot", (source_folder() / "configs/minerva.yaml").string(), "--mock", "--no-cameras"},
                    {.shell = "ulimit -c 0"});
    while (program.running() && program.said().empty()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    // To the main thread: one that just starts has nothing of the program on its stack.
    ASSERT_EQ(::tgkill(program.pid(), program.pid(), signal), 0);
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.exit_code, 128 + signal);
    EXPECT_THAT(outcome.last_line(),
                testing::MatchesRegex("foresight: crashed .*" + std::string(words) +
                                      ".* in thread 'foresight'; please report: .*foresight.0x.*"));
  }
}

TEST_F(Failure, AFullDeviceIsNamed) {
  const SmallRun run;
  run.keep("rgb.txt", 1);
  expect_refused(run_program({"replay", run.path(), "--report", "/dev/full"}), "/dev/full", "free some disk space");
}

TEST_F(Failure, AFullDiskIsNamed) {
  const SmallRun run;
  const fs::path disk = out_ / "disk";
  fs::create_directory(disk);
  if (::mount("foresight", disk.c_str(), "tmpfs", 0, "size=24k") != 0)
    GTEST_SKIP() << "no right to mount a small disk: " << std::strerror(errno);
  const Outcome outcome = run_program({"replay", run.path(), "--out", disk / "out"});
  const auto pictures = names_in(disk / "out/predicted");
  ::umount(disk.c_str());
  expect_refused(outcome, disk / "out", "free some disk space");
  for (const std::string& name : pictures) EXPECT_TRUE(name.ends_with(".png")) << name;  // nothing half-written
}

// Each small triangle needs a page of its own, however coarse.
TEST_F(Failure, TooLittleTextureMemoryIsNamed) {
  const TestRun run;
  constexpr int kSide = 60;
  std::string vertices, faces;
  std::mt19937 random(1);
  const auto noise = [&] {
    return std::to_string(0.004 * static_cast<double>(random()) / static_cast<double>(std::mt19937::max()));
  };
  for (int i = 0; i < kSide * kSide; ++i) {
    const double x = 0.01 * (i % kSide - kSide / 2), y = 0.01 * (i / kSide - kSide / 2);
    for (const auto& [dx, dy] : {std::pair{0.0, 0.0}, {0.006, 0.0}, {0.0, 0.006}})
      vertices += std::to_string(x + dx) + " " + std::to_string(y + dy) + " 1." + noise().substr(2) + "\n";
    faces += "3 " + std::to_string(3 * i) + " " + std::to_string(3 * i + 2) + " " + std::to_string(3 * i + 1) + "\n";
  }
  run.write("scene.ply", "ply\nformat ascii 1.0\nelement vertex " + std::to_string(3 * kSide * kSide) +
                             "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                             std::to_string(kSide * kSide) + "\nproperty list uchar int vertex_indices\nend_header\n" +
                             vertices + faces);
  run.write("camera.yaml",
            "image_width: 640\nimage_height: 480\ncamera_matrix: {rows: 3, cols: 3, data: [600, 0, 320, 0, 600, 240, "
            "0, 0, 1]}\n"
            "distortion_model: plumb_bob\ndistortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n");
  run.write("rgb.txt", "1700000000.0 rgb/a.png\n");
  run.write("rgb/a.png", encoded(".png", cv::Mat(480, 640, CV_8UC3, cv::Scalar(90, 120, 150))));
  expect_refused(run_program({"replay", run.path(), "--texture-memory-mb", "1"}), "out of texture memory",
                 "--texture-memory-mb");
  EXPECT_EQ(run_program({"replay", run.path(), "--texture-memory-mb", "64"}).exit_code, 0);
}

}  // namespace
}  // namespace foresight::failure_test
