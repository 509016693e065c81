// The operator's window on a screen of its own, by keys as a person presses them; the robot's side another program.
//
// Nothing is judged by how long it takes: each step waits for what the seat says of itself.
#include <fcntl.h>
#include <unistd.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/read_file.hpp"
#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"
#include "tests/link/child.hpp"
#include "tests/support/folders.hpp"

namespace foresight::operator_window_test {
namespace {

/// A display that nobody else draws on.
class VirtualScreen {
 public:
  VirtualScreen() {
    int ends[2];
    if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
    server_.emplace([&] {
      ::dup2(ends[1], 9);
      const int null = ::open("/dev/null", O_WRONLY);
      ::dup2(null, 1);
      ::dup2(null, 2);
      ::execlp("Xvfb", "Xvfb", "-displayfd", "9", "-screen", "0", "1000x700x24", "-nolisten", "tcp", nullptr);
      ::_exit(1);
    });
    ::close(ends[1]);
    char number[16] = {};
    const auto length = ::read(ends[0], number, sizeof number - 1);
    ::close(ends[0]);
    if (length > 1) name_ = ":" + std::string(number, static_cast<std::size_t>(length - 1));
  }
  /// "" where there is no Xvfb.
  const std::string& name() const { return name_; }
  /// What a person does at it. False: that failed.
  bool input(const std::string& words) const {
    return std::system(("DISPLAY=" + name_ + " xdotool " + words + " >/dev/null 2>&1").c_str()) == 0;
  }

 private:
  std::optional<Child> server_;
  std::string name_;
};

/// The lab's rig with few pictures a second, on a domain that stays on this host.
std::filesystem::path quiet_rig(const std::filesystem::path& folder) {
  const auto configs = source_folder() / "configs";
  std::string text = read_file(configs / "minerva.yaml");
  const auto replace = [&](const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != text.npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
  };
  replace("urdf: arm.urdf", "urdf: " + (configs / "arm.urdf").string());
  replace("rate_hz: 10", "rate_hz: 4");
  text += "link: {interface: lo, domain: " + std::to_string(1 + ::getpid() % 99) + ", round_trip_s: 5}\n";
  std::ofstream(folder / "rig.yaml") << text;
  return folder / "rig.yaml";
}

class OperatorWindow : public testing::Test {
 protected:
  void SetUp() override {
    if (screen_.name().empty()) GTEST_SKIP() << "no Xvfb here; scripts/setup installs it";
    rig_ = quiet_rig(folder_.path());
    robot_.emplace(std::vector<std::string>{"robot", rig_, "--mock", "--serve"});
    ProgramOptions options;
    options.environment["DISPLAY"] = screen_.name();
    options.folder = folder_.path();
    seat_.emplace(std::vector<std::string>{"operator", rig_, "--mock", "--rate-hz", "4"}, options);
  }

  /// The seat says so, after all that was read before.
  testing::AssertionResult says(const std::string& words) {
    const bool so = comes_true([&] {
      const std::size_t at = seat_->said().find(words, read_);
      if (at != std::string::npos) read_ = at + words.size();
      return at != std::string::npos || !seat_->running() || (robot_ && !robot_->running());
    });
    const std::string all = seat_->said();
    if (so && read_ > 0 && all.compare(read_ - words.size(), words.size(), words) == 0)
      return testing::AssertionSuccess();
    return testing::AssertionFailure() << "never said '" << words << "' after:\n"
                                       << all << "\nrobot:\n"
                                       << robot_->said();
  }
  bool press(const std::string& keys) const { return screen_.input("key " + keys); }
  bool hold(const std::string& key, bool down) const { return screen_.input((down ? "keydown " : "keyup ") + key); }

  /// The window as it is now.
  cv::Mat look() {
    std::filesystem::remove(folder_.path() / "foresight.png");
    EXPECT_TRUE(press("p"));
    EXPECT_TRUE(says("wrote foresight.png"));
    return cv::imread((folder_.path() / "foresight.png").string());
  }
  /// Share of a frame's pixels that are the red of pictures which are not to be trusted.
  static double red_share(const cv::Mat& picture) {
    cv::Mat red;
    cv::inRange(picture, cv::Scalar(0, 0, 90), cv::Scalar(60, 60, 255), red);
    const cv::Mat edge = red.colRange(0, 3);
    return static_cast<double>(cv::countNonZero(edge)) / static_cast<double>(edge.total());
  }
  /// Share of the middle's pixels that differ clearly.
  static double changed(const cv::Mat& one, const cv::Mat& other) {
    cv::Mat difference;
    cv::absdiff(one, other, difference);
    cv::cvtColor(difference, difference, cv::COLOR_BGR2GRAY);
    const cv::Rect middle(one.cols / 3, one.rows / 3, one.cols / 3, one.rows / 3);
    return static_cast<double>(cv::countNonZero(difference(middle) > 25)) / middle.area();
  }

  TempFolder folder_;
  VirtualScreen screen_;
  std::filesystem::path rig_;
  std::optional<Program> robot_, seat_;
  std::size_t read_ = 0;
};

TEST_F(OperatorWindow, ConnectsDrivesLosesTheLineAndRecovers) {
  ASSERT_TRUE(says("in command:   you"));
  ASSERT_TRUE(says("shown: "));
  ASSERT_TRUE(screen_.input("search --sync --name Foresight windowfocus"));

  // Consent: enabling, homing.
  ASSERT_TRUE(press("e"));
  ASSERT_TRUE(says("(H)"));
  ASSERT_TRUE(press("h"));
  ASSERT_TRUE(says("next:   ready"));
  const cv::Mat still = look();
  EXPECT_LT(red_share(still), 0.01);

  // Without the switch a key moves nothing; with it the tool goes.
  ASSERT_TRUE(hold("shift", true));
  ASSERT_TRUE(says("next:   driving"));
  ASSERT_TRUE(hold("r", true));
  cv::Mat moved;
  ASSERT_TRUE(comes_true([&] { return changed(still, moved = look()) > 0.02; }));
  ASSERT_TRUE(hold("r", false));

  // The line goes dead under the held switch: the newest image, in red; nothing counts before the switch was let go of.
  robot_->interrupt(SIGSTOP);
  ASSERT_TRUE(says("as prediction cannot be trusted"));
  EXPECT_GT(red_share(look()), 0.9);
  robot_->interrupt(SIGCONT);
  ASSERT_TRUE(says("the switch does not count"));
  ASSERT_TRUE(hold("shift", false));
  ASSERT_TRUE(says("next:   ready"));
  ASSERT_TRUE(hold("shift", true));
  ASSERT_TRUE(says("next:   driving"));
  EXPECT_LT(red_share(look()), 0.01);
  ASSERT_TRUE(hold("shift", false));

  // Windows of all sizes.
  ASSERT_TRUE(screen_.input("search --name Foresight windowsize 1 1"));
  ASSERT_TRUE(screen_.input("search --name Foresight windowsize 500 420"));
  ASSERT_TRUE(comes_true([&] { return look().cols == 500; }));

  ASSERT_TRUE(press("q"));
  EXPECT_EQ(seat_->wait().exit_code, 0);
}

}  // namespace
}  // namespace foresight::operator_window_test
