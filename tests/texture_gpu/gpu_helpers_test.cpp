// Work lists and the stage clock.
#include <algorithm>
#include <numeric>

#include "tests/support/headless_test.hpp"
#include "texture_gpu/shaders.hpp"
#include "texture_gpu/stage_clock.hpp"
#include "texture_gpu/work_list.hpp"

namespace foresight::gpu_helpers_test {
namespace {

using WorkListTest = HeadlessTest;

gl::Program with_lists(const std::string& text, const std::vector<std::string>& defines) {
  gl::ShaderSources sources = gl::texture_gpu_shaders();
  sources["probe.comp"] = text;
  return gl::Program::compute(sources, "probe.comp", defines);
}

const char* const kFill = R"(
#include "work_list.glsl"
layout(local_size_x = 64) in;
uniform int count;
void main() { int i = int(gl_GlobalInvocationID.x); if (i < count && i % 3 == 0) append_work(uint(i)); }
)";

const char* const kVisit = R"(
layout(local_size_x = GROUP) in;
#include "work_item.glsl"
layout(binding = 0, std430) buffer Visits { uint visits[]; };
void main() { uint item; if (next_work(item)) atomicAdd(visits[item], 1u); }
)";

// 200,000 / 3 items are more than the 65,535 groups that one dimension of a dispatch may have.
TEST_F(WorkListTest, EveryItemIsVisitedOnce) {
  struct Way {
    unsigned group, invocations;  // of an item; 0: a group each
  };
  for (const Way way : {Way{4, 0}, Way{64, 1}, Way{64, 16}, Way{96, 2}}) {
    std::vector<std::string> defines{"GROUP " + std::to_string(way.group)};
    if (way.invocations) defines.push_back("INVOCATIONS_PER_ITEM " + std::to_string(way.invocations));
    const gl::Program fill = with_lists(kFill, {}), visit = with_lists(kVisit, defines);
    WorkList list("test list");  // used again: what was listed before must be forgotten
    for (const int count : {200000, 0, 1, 190, 193, 3000}) {
      gl::Buffer visits(4 * static_cast<std::size_t>(std::max(count, 1)), "visits");
      visits.clear_to_zero();
      list.start(static_cast<std::size_t>(count));
      fill.set("count", count);
      fill.dispatch(std::max(count, 1));
      if (way.invocations)
        list.finish(visit, 15, way.invocations);
      else
        list.finish_for_groups();
      glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, visits.name());
      list.dispatch(visit);
      glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
      std::vector<unsigned> got(static_cast<std::size_t>(count));
      visits.read(std::span<unsigned>(got));
      const unsigned visits_of_item = way.invocations ? way.invocations : way.group;
      int wrong = 0;
      for (std::size_t i = 0; i < got.size(); ++i) wrong += got[i] != (i % 3 == 0 ? visits_of_item : 0u);
      EXPECT_EQ(wrong, 0) << count << " items, " << way.group << " a group, " << way.invocations << " an item";
    }
  }
}

using StageClockTest = HeadlessTest;

TEST_F(StageClockTest, NamesStagesInOrderAndAddsUpRepeatedOnes) {
  for (bool software : {true, false}) {
    StageClock clock(software);
    for (int image = 0; image < 2; ++image) {  // a new start forgets the last image
      clock.start();
      const double begin = process_cpu_ms();
      volatile double work = 0;
      while (process_cpu_ms() < begin + 15) work = work + 1;
      clock.mark("busy");
      clock.mark("idle");
      clock.mark("busy");
      glFinish();
      const auto costs = clock.read();
      ASSERT_EQ(costs.size(), 2u);
      EXPECT_EQ(costs[0].name, "busy");
      EXPECT_EQ(costs[1].name, "idle");
      EXPECT_GE(costs[0].cpu_ms, 14.9);
      EXPECT_GE(costs[1].cpu_ms, 0);
      EXPECT_LT(costs[1].cpu_ms, costs[0].cpu_ms);
      EXPECT_EQ(costs[0].gpu_ms.has_value(), !software);
    }
  }
}

}  // namespace
}  // namespace foresight::gpu_helpers_test
