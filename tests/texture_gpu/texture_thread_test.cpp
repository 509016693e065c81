#include "texture_gpu/texture_thread.hpp"

#include <gmock/gmock.h>

#include <thread>

#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "tests/texture_gpu/reference/atlas_pixels.hpp"
#include "texture_gpu/frame_gate.hpp"

namespace foresight::texture_thread_test {
namespace {

class TextureThreadTest : public HeadlessTest {
 protected:
  std::unique_ptr<TextureThread> start(std::uint64_t memory_bytes = 6 << 20,
                                       std::shared_ptr<FrameGate> gate = nullptr) {
    return std::make_unique<TextureThread>(
        context_->create_shared(),
        TextureThread::Setup{
            scene_, surface_, lens_, std::nullopt, {.memory_bytes = memory_bytes}, false, std::move(gate)});
  }
  PosedFrame frame(std::int64_t ns) const {
    PosedFrame out = picture_;
    out.left.time = RobotTime{ns};
    return out;
  }

  /// All texels that a generation shows, read from the GPU.
  std::vector<reference::Texel> shown(const PublishedTextures& textures) const {
    const reference::Generation generation(textures, surface_->charts.size());
    const reference::AtlasPixels pixels(*textures.colours);
    std::vector<reference::Texel> out;
    for (const std::uint32_t slot : generation.table)
      for (int k = 0; k < 256 && slot != atlas::kNoSlot; ++k) out.push_back(pixels.at(slot, 0, k % 16, k / 16));
    return out;
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  std::shared_ptr<const SurfacePatches> surface_ = std::make_shared<SurfacePatches>(find_surface_patches(*scene_, {}));
  Lens lens_ = small_lens("pinhole");
  PosedFrame picture_{posed_photograph(*scene_, state_of(*scene_), lens_, usual_view()), std::nullopt};
};

TEST_F(TextureThreadTest, PublishesWhatWasProcessed) {
  const auto thread = start();
  EXPECT_FALSE(thread->textures().acquire());
  EXPECT_FALSE(thread->take_report());
  for (int i = 1; i <= 3; ++i) {
    const ExtractionReport report = thread->process(frame(i));
    EXPECT_TRUE(report.published);
    EXPECT_EQ(report.newest_image.ns, i);
    const TextureLease lease = thread->textures().acquire();
    ASSERT_TRUE(lease);
    EXPECT_EQ(lease->newest_image.ns, i);
    EXPECT_FALSE(thread->take_report()) << "process() took it";
  }
  EXPECT_EQ(thread->replaced(), 0u);
}

TEST_F(TextureThreadTest, BeginsAnewWithNothing) {
  const auto thread = start();
  thread->process(frame(1));
  const std::vector<reference::Texel> first = shown(*thread->textures().acquire());
  PosedFrame other = frame(2);
  cv::bitwise_not(picture_.left.pixels, other.left.pixels = cv::Mat());
  thread->process(other);
  thread->begin_anew();
  EXPECT_FALSE(thread->textures().acquire());
  EXPECT_FALSE(thread->take_report());
  const ExtractionReport report = thread->process(frame(1));  // earlier than what it has forgotten
  EXPECT_TRUE(report.published);
  EXPECT_EQ(report.number, 1u);
  EXPECT_EQ(shown(*thread->textures().acquire()), first);
}

TEST_F(TextureThreadTest, TheNewestFrameWinsAndTheOthersAreCounted) {
  const auto thread = start();
  thread->process(frame(1));
  constexpr int kFrames = 40;
  for (int i = 2; i <= kFrames; ++i) thread->submit(frame(i));
  std::uint64_t finished = 1;
  std::int64_t newest = 0;
  for (int tries = 0; tries < 2000 && newest < kFrames; ++tries) {
    if (const auto report = thread->take_report()) newest = report->newest_image.ns;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(newest, kFrames) << "the last frame must never be lost";
  finished = thread->textures().acquire()->number;
  // Every frame was either extracted or replaced.
  EXPECT_EQ(finished + thread->replaced(), static_cast<std::uint64_t>(kFrames));
  EXPECT_GT(thread->replaced(), 0u);
}

// In slices between the frames of a display that leaves little: the same textures, to the last bit.
TEST_F(TextureThreadTest, SlicesBesideADisplayChangeNothing) {
  MonotonicClock clock;
  const auto gate = std::make_shared<FrameGate>(clock);
  const auto at_once = start(), in_slices = start(6 << 20, gate);
  std::jthread display([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      gate->frame_begins();
      std::this_thread::sleep_for(std::chrono::milliseconds(3));
      gate->frame_ends(clock.now() + std::chrono::milliseconds(4));
      std::this_thread::sleep_for(std::chrono::milliseconds(4));
    }
  });
  for (int i = 1; i <= 3; ++i) {
    EXPECT_TRUE(at_once->process(frame(i)).published);
    EXPECT_TRUE(in_slices->process(frame(i)).published);
    const TextureLease one = at_once->textures().acquire(), other = in_slices->textures().acquire();
    const auto a = shown(*one), b = shown(*other);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) ASSERT_TRUE(a[k] == b[k]) << "image " << i << ", texel " << k;
  }
  EXPECT_GT(gate->slices(), 3u);
}

TEST_F(TextureThreadTest, AnErrorReachesTheCallerAndStays) {
  const auto thread = start(210000);  // a few rows of pages
  PosedFrame little = frame(1);       // of the table alone
  little.left.T_world_camera = look_at({-0.46, -0.36, 0.1}, {-0.45, -0.36, 0});
  ASSERT_TRUE(thread->process(little).published);
  const TextureLease lease = thread->textures().acquire();
  const auto before = shown(*lease);
  ASSERT_FALSE(before.empty());

  EXPECT_THROW(thread->process(frame(2)), RuntimeFailure) << "all four nodes do not fit";
  EXPECT_THROW(thread->submit(frame(3)), RuntimeFailure);
  EXPECT_THROW(thread->take_report(), RuntimeFailure);
  EXPECT_FALSE(thread->textures().acquire()) << "nothing new comes from a dead core";
  EXPECT_EQ(shown(*lease), before) << "what is leased stays";
}

TEST_F(TextureThreadTest, ErrorsOfConstructionAreThrownByTheConstructor) {
  class Refuses final : public gl::Context {
   public:
    void make_current() override { throw RuntimeFailure("no context today", "try again"); }
    void release() override {}
    std::unique_ptr<gl::Context> create_shared() override { return nullptr; }
  };
  EXPECT_THAT(
      [&] {
        TextureThread(std::make_unique<Refuses>(), {scene_, surface_, lens_, std::nullopt, {}});
      },
      testing::ThrowsMessage<RuntimeFailure>(testing::HasSubstr("no context today")));
}

TEST_F(TextureThreadTest, StopsWhileBusyAndWithALeaseOut) {
  for (int wait_ms : {0, 1, 5, 20}) {
    auto thread = start();
    thread->process(frame(1));
    const TextureLease lease = thread->textures().acquire();
    const auto before = shown(*lease);
    ASSERT_GT(before.size(), 10000u);
    for (int i = 2; i < 5; ++i) thread->submit(frame(i));
    std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms));  // stop it at different places
    thread.reset();
    EXPECT_EQ(shown(*lease), before) << "stopped after " << wait_ms << " ms";
  }
}

TEST_F(TextureThreadTest, GivesUpWaitingAfterTheTimeOut) {
  const auto thread = start();
  thread->process(frame(1));
  EXPECT_THROW(thread->process(frame(2), 0.0), RuntimeFailure);
}

}  // namespace
}  // namespace foresight::texture_thread_test
