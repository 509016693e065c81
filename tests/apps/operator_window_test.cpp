// The operator's window on a screen of its own, by keys as a person presses them; the robot's side another program.
//
// Nothing is judged by how long it takes: each step waits for what the seat says of itself.
#include <fcntl.h>
#include <unistd.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "link/config/own_domain.hpp"
#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"
#include "tests/link/child.hpp"

namespace foresight::operator_window_test {
namespace {

bool there_is(const std::string& program) {
  return std::system(("command -v " + program + " >/dev/null").c_str()) == 0;
}

/// A display that nobody else draws on.
class VirtualScreen {
 public:
  VirtualScreen() {
    constexpr int kTries = 5;  // another server may take the number that this one has just found free
    for (int i = 0; i < kTries && name_.empty(); ++i) start();
  }
  /// "" where no server starts.
  const std::string& name() const { return name_; }
  /// What a person does at it. False: that failed.
  bool input(const std::string& words) const {
    return std::system(("DISPLAY=" + name_ + " xdotool " + words + " >/dev/null 2>&1").c_str()) == 0;
  }

 private:
  void start() {
    int ends[2];
    if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
    server_.reset();
    server_.emplace([&] {
      ::dup2(ends[1], 9);
      const int null = ::open("/dev/null", O_WRONLY);
      ::dup2(null, 1);
      ::dup2(null, 2);
      ::execlp("Xvfb", "Xvfb", "-displayfd", "9", "-screen", "0", "1000x700x24", "-nolisten", "tcp", nullptr);
      ::_exit(1);
    });
    ::close(ends[1]);
    std::string number;
    for (char c = 0; ::read(ends[0], &c, 1) == 1 && c != '\n';) number += c;
    ::close(ends[0]);
    if (!number.empty()) name_ = ":" + number;
  }

  std::optional<Child> server_;
  std::string name_;
};

/// The lab's rig with few and small pictures, on a domain that stays on this host.
std::string quiet_rig(const TempFolder& folder, int domain) {
  const std::string rig = small_rig("minerva.yaml", folder, "160, 120", 4);
  std::ofstream(rig, std::ios::app) << "link: {interface: lo, domain: " << domain << ", round_trip_s: 2}\n";
  return rig;
}

class OperatorWindow : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* program : {"Xvfb", "xdotool"})
      if (!there_is(program)) GTEST_SKIP() << "no " << program << " here; scripts/setup installs it";
    screen_.emplace();
    ASSERT_NE(screen_->name(), "") << "Xvfb does not start";
    rig_ = quiet_rig(folder_, domain_.number());
    robot_.emplace(std::vector<std::string>{"robot", rig_, "--mock", "--serve"});
    ProgramOptions options;
    options.environment["DISPLAY"] = screen_->name();
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
  bool press(const std::string& keys) const { return screen_->input("key " + keys); }
  bool hold(const std::string& key, bool down) const { return screen_->input((down ? "keydown " : "keyup ") + key); }

  /// Does what the seat says is to be done next, until it is ready. Again after a while where that changed nothing, as
  /// a person does: what was asked for while the robot still stopped is not followed.
  testing::AssertionResult gets_ready() {
    constexpr unsigned kAgain = 300;  // looks
    std::string done;
    unsigned looks = 0;
    const bool ready = comes_true([&] {
      const std::string next = last("next");
      if (next.find("next:   ready ->") != std::string::npos) return true;
      if (next == done && ++looks % kAgain != 0) return false;
      done = next;
      do_as_told(next);
      return false;
    });
    if (ready) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "never got ready:\n" << seat_->said() << "\nrobot:\n" << robot_->said();
  }
  void do_as_told(const std::string& next) {
    if (next.find("let go") != std::string::npos) hold("shift", false);
    for (const char key : {'E', 'H', 'Z', 'X'})
      if (next.find(std::string("(") + key + ")") != std::string::npos)
        press(std::string(1, static_cast<char>(key + 32)));
  }
  /// Holds the switch until it counts: a window that is slow to look for keys lets go of it by itself.
  testing::AssertionResult drives() {
    constexpr unsigned kRetry = 2000;  // looks
    for (int tries = 0; tries < 10; ++tries) {
      if (last("next").find("driving") != std::string::npos) return testing::AssertionSuccess();
      hold("shift", false);
      if (!gets_ready()) break;
      hold("shift", true);
      comes_true([&] { return last("next").find("next:   ready") == std::string::npos; }, kRetry);
      comes_true([&] { return last("next").find("waiting for the robot") == std::string::npos; }, kRetry);
    }
    return testing::AssertionFailure() << "never drove:\n" << seat_->said();
  }
  std::string line_at(std::size_t at) const {
    const std::string all = seat_->said();
    return at < all.size() ? all.substr(at, all.find('\n', at) - at) : "";
  }
  /// The newest line of that label.
  std::string last(const std::string& label) const { return line_at(seat_->said().rfind("operator: " + label + ": ")); }

  /// The window as it is now.
  cv::Mat look() {
    const std::string name = "foresight-001.png";
    std::filesystem::remove(folder_.path() / name);
    EXPECT_TRUE(press("p"));
    EXPECT_TRUE(says("wrote " + name));
    return cv::imread((folder_.path() / name).string());
  }
  /// Share of a frame's pixels that are the red of pictures which are not to be trusted.
  static double red_share(const cv::Mat& picture) {
    cv::Mat red;
    cv::inRange(picture, cv::Scalar(0, 0, 90), cv::Scalar(60, 60, 255), red);
    const cv::Mat edge = red.colRange(0, 3);
    return static_cast<double>(cv::countNonZero(edge)) / static_cast<double>(edge.total());
  }
  /// The window looks as the seat says.
  testing::AssertionResult shows(const std::string& words, bool red) {
    const auto so = [&] { return last("shown").find(words) != std::string::npos; };
    if (comes_true([&] { return so() && (red_share(look()) > 0.9) == red && so(); }))
      return testing::AssertionSuccess();
    return testing::AssertionFailure() << "never showed '" << words << "':\n" << seat_->said();
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
  link::OwnDomain domain_;
  std::optional<VirtualScreen> screen_;
  std::string rig_;
  std::optional<Program> robot_, seat_;
  std::size_t read_ = 0;
};

TEST_F(OperatorWindow, ConnectsDrivesLosesTheRobotAndRecovers) {
  ASSERT_TRUE(says("in command:   you"));
  ASSERT_TRUE(screen_->input("search --sync --name Foresight windowfocus"));
  // Before joints are homed: the newest image, why, and nothing in red.
  ASSERT_TRUE(says("joints tell no position"));
  EXPECT_TRUE(shows("as prediction cannot be trusted", false));
  ASSERT_TRUE(gets_ready());  // consent: enabling, homing
  EXPECT_TRUE(shows("as it will be", false));
  for (const auto& [key, words] :
       {std::pair{"F3", "from beside"}, {"F2", "left eye | right eye"}, {"Tab", "as it will be"}}) {
    ASSERT_TRUE(press(key));
    EXPECT_TRUE(shows(words, false));
  }
  const cv::Mat still = look();

  // Without the switch a key moves nothing; with it the camera turns, and what is shown with it at once.
  ASSERT_TRUE(hold("Left", true));
  ASSERT_TRUE(drives());
  ASSERT_TRUE(comes_true([&] { return changed(still, look()) > 0.02 || !drives(); }));
  ASSERT_TRUE(hold("Left", false));

  // Nothing comes any more under the held switch: the newest image, in red.
  ASSERT_TRUE(drives());
  robot_->interrupt(SIGSTOP);
  EXPECT_TRUE(shows("as prediction cannot be trusted", true));

  // The robot's program stood still, so its drives stopped by themselves. What is said to be done helps, and the switch
  // counts only once it was let go of.
  robot_->interrupt(SIGCONT);
  ASSERT_TRUE(says("robot: ! stopped"));
  ASSERT_TRUE(gets_ready());
  ASSERT_TRUE(drives());
  EXPECT_TRUE(shows("as it will be", false));
  ASSERT_TRUE(hold("shift", false));

  // Windows of all sizes.
  ASSERT_TRUE(screen_->input("search --name Foresight windowsize 1 1"));
  ASSERT_TRUE(screen_->input("search --name Foresight windowsize 500 420"));
  ASSERT_TRUE(comes_true([&] { return look().cols == 500; }));

  // Again, where a slow window has not seen the open switch yet.
  ASSERT_TRUE(comes_true([&] { return !press("q") || !seat_->running(); }));
  const Outcome end = seat_->wait();
  EXPECT_EQ(end.exit_code, 0) << end.err;
}

}  // namespace
}  // namespace foresight::operator_window_test
