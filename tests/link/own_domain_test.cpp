#include "link/config/own_domain.hpp"

#include "child.hpp"
#include "common/error.hpp"
#include "tests/support/private_network.hpp"

namespace foresight::link::own_domain_test {
namespace {

class OwnDomains : public PrivateNetworkTest {};

TEST_F(OwnDomains, NobodyElseHasTheSame) {
  const OwnDomain one;
  std::optional<OwnDomain> two(std::in_place);
  EXPECT_EQ(one.number(), OwnDomain::kFirst);
  EXPECT_EQ(two->number(), OwnDomain::kFirst + 1);
  const OwnDomain three;
  EXPECT_EQ(three.number(), OwnDomain::kFirst + 2);
  two.reset();
  EXPECT_EQ(OwnDomain().number(), OwnDomain::kFirst + 1) << "what was let go is not held on to";
}

TEST_F(OwnDomains, AnotherProgramHoldsItsOwnUntilItIsKilled) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  {
    const Child other([&] {
      const OwnDomain held;
      ::write(ends[1], "x", 1);
      ::pause();
    });
    char said = 0;
    ASSERT_EQ(::read(ends[0], &said, 1), 1);
    EXPECT_EQ(OwnDomain().number(), OwnDomain::kFirst + 1);
  }
  EXPECT_EQ(OwnDomain().number(), OwnDomain::kFirst);
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST_F(OwnDomains, MoreThanThereAreAreRefused) {
  std::vector<OwnDomain> all(OwnDomain::kDomains);
  EXPECT_THAT([] { OwnDomain(); }, testing::ThrowsMessage<RuntimeFailure>(testing::AllOf(
                                       testing::HasSubstr("from 100 to 199 are held"), testing::HasSubstr("fewer"))));
}

}  // namespace
}  // namespace foresight::link::own_domain_test
