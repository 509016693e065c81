// A daemon of our own that speaks spacenavd's protocol: eight words of 32 bits an event.
#include "input/space_mouse.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <cstdlib>
#include <thread>

#include "common/unique_fd.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::space_mouse_test {
namespace {

using namespace std::chrono_literals;

/// Takes one client, and greets it as protocol 1 says.
class PretendedDaemon {
 public:
  explicit PretendedDaemon(const std::filesystem::path& socket) : listening_(::socket(AF_UNIX, SOCK_STREAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    socket.string().copy(address.sun_path, sizeof address.sun_path - 1);
    std::filesystem::remove(socket);
    EXPECT_EQ(::bind(listening_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::listen(listening_.get(), 1), 0);
  }
  /// Runs `open`, which connects, and answers it meanwhile.
  template <typename Open>
  void greet(Open&& open) {
    std::jthread daemon([this] {
      client_ = UniqueFd(::accept(listening_.get(), nullptr, nullptr));
      std::int32_t word = 0;
      if (::recv(client_.get(), &word, sizeof word, 0) != sizeof word) return;
      ::send(client_.get(), &word, sizeof word, MSG_NOSIGNAL);
    });
    open();
  }
  void say(const std::array<std::int32_t, 8>& event) const {
    EXPECT_EQ(::send(client_.get(), event.data(), sizeof event, MSG_NOSIGNAL), ssize_t{sizeof event});
  }
  void say_bytes(std::string_view bytes) const { ::send(client_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL); }
  void motion(std::int32_t x, std::int32_t y, std::int32_t z, std::int32_t rx = 0, std::int32_t ry = 0,
              std::int32_t rz = 0) const {
    say({0, x, y, z, rx, ry, rz, 16});
  }
  void button(std::int32_t number, bool down) const { say({down ? 1 : 2, number}); }
  void drop() { client_ = UniqueFd(); }

 private:
  UniqueFd listening_, client_;
};

class SpaceMouseTest : public testing::Test {
 protected:
  SpaceMouseTest() { ::setenv("SPNAV_SOCKET", (folder_ / "spnav.sock").c_str(), 1); }
  ~SpaceMouseTest() override { ::unsetenv("SPNAV_SOCKET"); }
  void open() {
    daemon_.emplace(folder_ / "spnav.sock");
    daemon_->greet([this] { device_.emplace(); });
  }
  TrackerState rounds(int count) {
    TrackerState out;
    for (int i = 0; i < count; ++i) out = device_->read(now_ = now_ + 10ms);
    return out;
  }
  TempFolder folder_;
  std::optional<PretendedDaemon> daemon_;
  std::optional<SpaceMouse> device_;
  OperatorTime now_{1'000'000'000};
};

TEST_F(SpaceMouseTest, WithoutItsDaemonItSaysWhatToDo) {
  device_.emplace();
  const TrackerState state = rounds(2);
  EXPECT_FALSE(state.connected);
  EXPECT_NE(std::string(state.cure).find("spacenavd"), std::string::npos);
}

TEST_F(SpaceMouseTest, TheCapMovesTheHand) {
  open();
  ASSERT_TRUE(rounds(1).connected);
  daemon_->motion(0, 0, 350);
  const Eigen::Vector3d forward = rounds(40).T_space_hand.translation();
  EXPECT_NEAR(forward.x(), 0.15 * 0.4, 2e-3);
  daemon_->motion(350, 0, 0);
  const Eigen::Vector3d right = rounds(40).T_space_hand.translation() - forward;
  EXPECT_NEAR(right.y(), -0.06, 2e-3);
  daemon_->motion(0, 0, 0);
  const TrackerState at_rest = rounds(1);
  EXPECT_EQ(rounds(50).T_space_hand.matrix(), at_rest.T_space_hand.matrix());
}

TEST_F(SpaceMouseTest, ButtonsHoldTheSwitchAndMoveTheGripper) {
  open();
  daemon_->button(0, true);
  EXPECT_TRUE(rounds(1).buttons.held(TrackerButton::deadman));
  daemon_->button(1, true);
  EXPECT_TRUE(rounds(1).buttons.held(TrackerButton::gripper_close));
  daemon_->button(1, false);
  EXPECT_FALSE(rounds(1).buttons.held(TrackerButton::gripper_close));
  daemon_->button(1, true);
  EXPECT_TRUE(rounds(1).buttons.held(TrackerButton::gripper_open)) << "the next time";
}

TEST_F(SpaceMouseTest, AStaleDeflectionEnds) {
  open();
  daemon_->motion(0, 350, 0);
  rounds(60);
  const TrackerState later = rounds(1);
  EXPECT_EQ(rounds(200).T_space_hand.matrix(), later.T_space_hand.matrix());
  EXPECT_LE(later.T_space_hand.translation().z(), 0.15 * 0.52);
}

TEST_F(SpaceMouseTest, ADaemonThatGoesTakesTheSwitchAlongAndIsFoundAgain) {
  open();
  daemon_->motion(350, 0, 0);
  daemon_->button(0, true);
  ASSERT_TRUE(rounds(2).buttons.held(TrackerButton::deadman));
  daemon_->drop();
  const TrackerState gone = rounds(1);
  EXPECT_FALSE(gone.connected);
  EXPECT_FALSE(gone.buttons.held(TrackerButton::deadman));
  EXPECT_EQ(rounds(20).T_space_hand.matrix(), gone.T_space_hand.matrix());
  daemon_->greet([this] { rounds(200); });
  const TrackerState back = rounds(1);
  EXPECT_TRUE(back.connected);
  EXPECT_FALSE(back.buttons.held(TrackerButton::deadman));
}

TEST_F(SpaceMouseTest, UnpluggedFromItsDaemonItHasGone) {
  open();
  daemon_->button(0, true);
  ASSERT_TRUE(rounds(1).connected);
  daemon_->say({3, 1});  // a device was removed
  const TrackerState gone = rounds(1);
  EXPECT_FALSE(gone.connected);
  EXPECT_NE(std::string(gone.trouble).find("unplugged"), std::string::npos);
}

TEST_F(SpaceMouseTest, NonsenseDoesNoHarm) {
  open();
  daemon_->say({99, -1, -1});
  daemon_->say({-5, 7});
  daemon_->say({1, 1 << 30});
  daemon_->motion(std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max(), 0);
  const double before = rounds(1).T_space_hand.translation().norm();
  EXPECT_LE(rounds(10).T_space_hand.translation().norm() - before, 0.15 * 0.1 + 1e-9);
  daemon_->say_bytes("abc");
  EXPECT_TRUE(rounds(3).connected);
}

}  // namespace
}  // namespace foresight::space_mouse_test
