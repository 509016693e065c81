#include "texture_gpu/fill_list.hpp"

#include <gmock/gmock.h>

namespace foresight::fill_list_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

using PageRun = std::array<int, 3>;  // first before, first now, count

/// Charts of one row of so many pages each, in this order in the page table.
std::vector<AtlasChart> charts_of(std::initializer_list<int> pages) {
  std::vector<AtlasChart> out;
  int first = 0;
  for (const int count : pages) {
    out.emplace_back();
    out.back().pages = {count, 1};
    out.back().first_page = first;
    out.back().relevelled = false;
    first += count;
  }
  return out;
}

PageJob job_of(std::uint32_t chart) {
  PageJob out{};
  out.chart = chart;
  return out;
}

TEST(FillList, KeepsRunsOfChartsThatDidNotChange) {
  FillList list;
  list.list(charts_of({2, 0, 1, 3}), {});
  // The first grew, so that the others moved.
  std::vector<AtlasChart> grown = charts_of({4, 0, 1, 3});
  grown[0].relevelled = true;
  const FillPass::Work moved = list.list(grown, {});
  EXPECT_THAT(moved.dirty, ElementsAre(0u));
  EXPECT_THAT(moved.chart_of_page, ElementsAre(0u, 0u, 0u, 0u, 2u, 3u, 3u, 3u));
  EXPECT_THAT(moved.kept, ElementsAre(PageRun{2, 4, 4})) << "neighbours are one run";

  const std::array jobs{job_of(2)};
  const FillPass::Work changed = list.list(charts_of({4, 0, 1, 3}), jobs);
  EXPECT_EQ(changed.job_count, 1u);
  EXPECT_THAT(changed.dirty, ElementsAre(2u));
  EXPECT_THAT(changed.kept, ElementsAre(PageRun{0, 0, 4}, PageRun{5, 5, 3}));
}

TEST(FillList, HasNothingToDoWithoutPages) {
  FillList list;
  const FillPass::Work work = list.list(charts_of({0, 0}), {});
  EXPECT_THAT(work.dirty, IsEmpty());
  EXPECT_THAT(work.kept, IsEmpty());
}

}  // namespace
}  // namespace foresight::fill_list_test
