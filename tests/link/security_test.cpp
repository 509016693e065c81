// Certificates, and who is let onto a secured line.
#include <unistd.h>

#include <fstream>

#include "child.hpp"
#include "common/error.hpp"
#include "common/read_file.hpp"
#include "link/dds/endpoints.hpp"
#include "link/dds/topics.hpp"
#include "link/keys/certificates.hpp"
#include "link/keys/keys.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/private_network.hpp"

namespace foresight::link::security_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Keys : public testing::Test {
 protected:
  void SetUp() override { make_keys(folder_ / "keys", 30); }
  std::string refusal(Role role = Role::robot) const {
    return input_error([&] { check_keys(folder_ / "keys", role, "rig.yaml:4: link.security"); });
  }
  fs::path file(const char* role, const char* name) const { return folder_ / "keys" / role / name; }
  void replace(const fs::path& what, const fs::path& with) const {
    fs::copy_file(with, what, fs::copy_options::overwrite_existing);
  }

  TempFolder folder_;
};

TEST_F(Keys, EveryRoleIsLetIn) {
  for (const Role role : {Role::robot, Role::operating, Role::observer})
    EXPECT_NO_THROW(check_keys(folder_ / "keys", role, "here")) << to_string(role);
  EXPECT_EQ(fs::status(folder_ / "keys" / "robot").permissions(), fs::perms::owner_all);
  EXPECT_FALSE(fs::exists(file("robot", "../robot/authority-key.pem")));
  EXPECT_THAT([&] { make_keys(folder_ / "keys", 30); },
              testing::ThrowsMessage<InputError>(HasSubstr("has something in it")));
}

TEST_F(Keys, AnEmptyFolderIsFilledInItsPlace) {
  const fs::path stick = folder_ / "stick";  // as where a disk is mounted: nothing can take its place
  fs::create_directory(stick);
  fs::create_directory_symlink(stick, folder_ / "link");
  make_keys(folder_ / "link", 30);
  EXPECT_NO_THROW(check_keys(stick, Role::robot, "here"));
  EXPECT_EQ(std::distance(fs::directory_iterator(stick), fs::directory_iterator()), 4);
}

TEST_F(Keys, WhatIsMissingIsNamed) {
  fs::remove(file("robot", "key.pem"));
  EXPECT_THAT(refusal(), HasSubstr("rig.yaml:4: link.security: the robot's key.pem is missing"));
  EXPECT_EQ(refusal(Role::observer), "no error") << "others do not need it";
}

TEST_F(Keys, AFolderThatIsMissingIsNamed) {
  fs::remove_all(folder_ / "keys");
  EXPECT_THAT(refusal(), AllOf(HasSubstr("rig.yaml:4: link.security: there is no folder "), HasSubstr("link keys")));
}

TEST_F(Keys, WhatHasExpiredIsNamedWithItsDate) {
  make_keys(folder_ / "old", -1);
  fs::remove_all(folder_ / "keys");
  fs::rename(folder_ / "old", folder_ / "keys");
  EXPECT_THAT(refusal(), HasSubstr("authority.pem has expired on "));
}

TEST_F(Keys, WhatAnotherAuthorityMadeIsNamed) {
  make_keys(folder_ / "other", 30);
  replace(file("robot", "certificate.pem"), folder_ / "other" / "robot" / "certificate.pem");
  EXPECT_THAT(refusal(), HasSubstr("certificate.pem was made by another authority"));
  replace(file("observer", "permissions.p7s"), folder_ / "other" / "observer" / "permissions.p7s");
  EXPECT_THAT(refusal(Role::observer), HasSubstr("permissions.p7s was not signed by this authority"));
}

TEST_F(Keys, WhatBelongsToAnotherRoleIsNamed) {
  replace(file("observer", "permissions.p7s"), file("operator", "permissions.p7s"));
  EXPECT_THAT(refusal(Role::observer), HasSubstr("permissions.p7s does not permit the role observer"));
  replace(file("robot", "key.pem"), file("operator", "key.pem"));
  EXPECT_THAT(refusal(), HasSubstr("key.pem is not the key of its certificate"));
}

TEST_F(Keys, WhatWasChangedIsNamed) {
  std::ifstream in(file("observer", "permissions.p7s"));
  std::string text((std::istreambuf_iterator<char>(in)), {});
  const std::size_t at = text.find("<subscribe>");
  ASSERT_NE(at, text.npos);
  text.insert(at, "<publish><topics><topic>*</topic></topics></publish>");
  std::ofstream(file("observer", "permissions.p7s")) << text;
  EXPECT_THAT(refusal(Role::observer), HasSubstr("was not signed by this authority, or was changed"));
  std::ofstream(file("robot", "certificate.pem")) << "-----BEGIN CERTIFICATE-----\nnonsense\n";
  EXPECT_THAT(refusal(), HasSubstr("certificate.pem is no certificate"));
}

TEST_F(Keys, WhatAnOlderVersionMadeIsNamedWithWhatItLacks) {
  const std::string signed_text = read_file(file("robot", "permissions.p7s"));
  const std::size_t begin = signed_text.find("<?xml"), end = signed_text.find("</dds>");
  ASSERT_LT(begin, end);
  std::string text = signed_text.substr(begin, end - begin) + "</dds>\n";
  const std::string topic = "<topic>rt/foresight/gate_motion</topic>";
  const std::size_t at = text.find(topic);
  ASSERT_NE(at, text.npos);
  text.erase(at, topic.size());
  const Credentials authority{read_file(file("authority", "key.pem")), read_file(file("authority", "certificate.pem"))};
  std::ofstream(file("robot", "permissions.p7s")) << sign(authority, text);
  EXPECT_THAT(refusal(), AllOf(HasSubstr("permissions.p7s is of an older version: it does not permit to write "
                                         "rt/foresight/gate_motion"),
                               HasSubstr("make keys anew with `foresight link keys`")));
}

// --- on the wire ----------------------------------------------------------------------------------------------------

class SecuredLine : public PrivateNetworkTest {
 protected:
  void SetUp() override {
    PrivateNetworkTest::SetUp();
    if (IsSkipped()) return;
    make_keys(folder_ / "keys", 30);
    make_keys(folder_ / "foreign", 30);
  }
  LinkConfig with(const char* keys) const {
    LinkConfig out;
    if (keys) out.security = folder_ / keys;
    return out;
  }
  /// Writes `text` again and again.
  std::function<void()> talker(const LinkConfig& config, const char* text) const {
    return [config, text] {
      Participant program(config, "operator", Role::operating);
      Writer writer(program, topic_);
      for (Header message{{}, text};; ::usleep(10'000)) writer.write(to_cdr(message));
    };
  }
  static inline const Topic topic_{"rt/foresight/reports", Header::kType, Delivery::newest, 64};
  TempFolder folder_;
};

// Strangers begin first and speak without end: of all that arrives by the time that the true operator has been heard
// fifty times, nothing is theirs, and they match no reader of the robot's.
TEST_F(SecuredLine, OnlyCertificatesOfTheAuthorityAreHeard) {
  const Child plain(talker(with(nullptr), "plain")), foreign(talker(with("foreign"), "foreign"));
  const Child good(talker(with("keys"), "good"));
  Participant robot(with("keys"), "robot", Role::robot);
  Reader reader(robot, topic_);
  std::map<std::string, int> heard;
  EXPECT_TRUE(comes_true([&] {
    reader.take([&](const Sample& sample) { ++heard[from_cdr<Header>(sample.cdr)->frame_id]; });
    return heard["good"] >= 50;
  }));
  EXPECT_EQ(heard["plain"], 0);
  EXPECT_EQ(heard["foreign"], 0);
  EXPECT_EQ(reader.writers(), 1u);
}

TEST_F(SecuredLine, AnObserverReadsAndCannotCommand) {
  const Child good(talker(with("keys"), "good"));
  Participant observer(with("keys"), "observer", Role::observer);
  Reader reader(observer, topic_);
  EXPECT_TRUE(comes_true([&] { return reader.take([](const Sample&) {}) > 0; }));
  const auto refused = testing::ThrowsMessage<RuntimeFailure>(HasSubstr("certificate does not permit it"));
  EXPECT_THAT([&] { Writer(observer, topic_); }, refused);
  EXPECT_THAT([&] { Writer(observer, {"rt/foresight/control/operator/set_points", Header::kType}); }, refused);
  EXPECT_THAT([&] { Writer(observer, {"rt/joint_states", Header::kType}); }, refused);
}

TEST_F(SecuredLine, AnOperatorCannotSpeakForTheRobot) {
  Participant program(with("keys"), "operator", Role::operating);
  EXPECT_NO_THROW(Writer(program, {"rt/foresight/control/operator/set_points", Header::kType}));
  EXPECT_THAT(
      [&] {
        Writer(program, {"rt/foresight/frames", Header::kType});
      },
      testing::ThrowsMessage<RuntimeFailure>(HasSubstr("certificate does not permit it")));
}

// Whatever this version writes, its keys permit.
TEST_F(SecuredLine, ARobotMayWriteAllTopicsOfARobot) {
  Participant robot(with("keys"), "robot", Role::robot);
  for (const Topic& topic :
       {topics::frames(), topics::pieces(), topics::robot_state(), topics::gate_motion(), topics::joint_states(),
        topics::set_points(), topics::transforms(), topics::static_transforms(), topics::diagnostics(),
        topics::compressed_images("left"), topics::compressed_images("right"), topics::camera_info("left"),
        topics::camera_info("right")})
    EXPECT_NO_THROW(Writer(robot, topic)) << topic.name;
}

TEST_F(SecuredLine, WrongKeysAreToldBeforeAnythingIsSent) {
  fs::remove_all(folder_ / "keys" / "robot");
  EXPECT_THAT([&] { Participant(with("keys"), "robot", Role::robot); },
              testing::ThrowsMessage<InputError>(HasSubstr("the robot's authority.pem is missing")));
}

}  // namespace
}  // namespace foresight::link::security_test
