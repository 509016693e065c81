// The operator's window on a screen of its own, by keys as a person presses them; the robot's side another program.
//
// Nothing is judged by how long it takes: each step waits for what the seat says of itself.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "link/config/own_domain.hpp"
#include "tests/apps/program.hpp"
#include "tests/apps/runs.hpp"
#include "tests/link/child.hpp"

namespace foresight {

inline bool there_is(const std::string& program) {
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
      // A server that starts anew when its last client leaves turns away whoever comes just then.
      ::execlp("Xvfb", "Xvfb", "-displayfd", "9", "-screen", "0", "1000x700x24", "-nolisten", "tcp", "-noreset",
               nullptr);
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
inline std::string quiet_rig(const TempFolder& folder, int domain, int images_hz = 4) {
  const std::string rig = small_rig("minerva.yaml", folder, "160, 120", images_hz);
  std::ofstream(rig, std::ios::app) << "link: {interface: lo, domain: " << domain << ", round_trip_s: 2}\n";
  return rig;
}

class OperatorWindow : public testing::Test {
 protected:
  /// More options: of both programs; of the seat.
  explicit OperatorWindow(std::vector<std::string> sides = {}, std::vector<std::string> seat = {"--rate-hz", "4"})
      : sides_(std::move(sides)), seat_options_(std::move(seat)) {}
  virtual std::string make_rig() { return quiet_rig(folder_, domain_.number()); }
  void SetUp() override {
    for (const char* program : {"Xvfb", "xdotool"})
      if (!there_is(program)) GTEST_SKIP() << "no " << program << " here; scripts/setup installs it";
    screen_.emplace();
    ASSERT_NE(screen_->name(), "") << "Xvfb does not start";
    rig_ = make_rig();
    const auto with_sides = [this](std::vector<std::string> words) {
      words.insert(words.end(), sides_.begin(), sides_.end());
      return words;
    };
    robot_.emplace(with_sides({"robot", rig_, "--mock", "--serve"}));
    ProgramOptions options;
    options.environment["DISPLAY"] = screen_->name();
    options.folder = folder_.path();
    std::vector<std::string> seat = with_sides({"operator", rig_, "--mock"});
    seat.insert(seat.end(), seat_options_.begin(), seat_options_.end());
    seat_.emplace(seat, options);
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
  /// Its newest line of that label comes to have these words, whatever was said before or after it.
  testing::AssertionResult tells(const std::string& label, const std::string& words) {
    if (comes_true([&] { return last(label).find(words) != std::string::npos || !seat_->running(); }) &&
        last(label).find(words) != std::string::npos)
      return testing::AssertionSuccess();
    return testing::AssertionFailure() << label << " never told '" << words << "':\n" << seat_->said();
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

  std::vector<std::string> sides_, seat_options_;
  TempFolder folder_;
  link::OwnDomain domain_;
  std::optional<VirtualScreen> screen_;
  std::string rig_;
  std::optional<Program> robot_, seat_;
  std::size_t read_ = 0;
};

}  // namespace foresight
