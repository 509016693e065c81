#include "texture_gpu/page_ages.hpp"

#include <gmock/gmock.h>

namespace foresight::page_ages_test {
namespace {

using testing::ElementsAre;
using testing::FloatEq;

AtlasPage page(std::int64_t last_seen, std::int64_t written) {
  AtlasPage out;
  out.last_seen = last_seen;
  out.written = written;
  return out;
}

RobotTime at(double t) {
  return RobotTime{} + seconds(t);
}

TEST(PageAges, AreTimesSincePagesWereSeenInThisLight) {
  std::vector<AtlasChart> charts(2);
  charts[0].page = {page(-1, -1), page(0, 0)};
  charts[1].page = {page(2, 1)};
  PageAges ages;
  ages.update(charts, 0, at(1), -1);
  ages.update(charts, 1, at(1.5), -1);
  ages.update(charts, 2, at(4), -1);
  EXPECT_THAT(ages.seconds(), ElementsAre(FloatEq(-1), FloatEq(3), FloatEq(0)));
  ages.update(charts, 3, at(5), 2);
  EXPECT_THAT(ages.seconds(), ElementsAre(FloatEq(-1), FloatEq(4), FloatEq(3.5))) << "of the old light: when written";
}

}  // namespace
}  // namespace foresight::page_ages_test
