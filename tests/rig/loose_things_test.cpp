#include "rig/loose_things.hpp"

#include "scene/yaml_fields.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::loose_things_test {
namespace {

std::vector<LooseThing> read(const std::string& text) {
  return read_loose_things(YamlMap::parse("rig.yaml", text));
}

TEST(LooseThings, AreReadWithWhatTheyAreMadeOf) {
  EXPECT_TRUE(read("name: none\n").empty());
  const auto things = read(
      "name: some\n"
      "things:\n"
      "  - {node: brick, mass_kg: 0.09, friction: 0.7, tag: {id: 5, side_m: 0.03, pose: {xyz: [0, 0, 0.065]}}}\n"
      "  - {node: ball, mass_kg: 0.045, rolling_m: 0.0004, restitution: 0.5}\n");
  ASSERT_EQ(things.size(), 2u);
  EXPECT_EQ(things[0].node, "brick");
  EXPECT_EQ(things[0].surface.friction, 0.7);
  ASSERT_TRUE(things[0].tag);
  EXPECT_EQ(things[0].tag->id, 5);
  EXPECT_EQ(things[0].tag->T_thing_tag.translation().z(), 0.065);
  EXPECT_FALSE(things[1].tag);
  EXPECT_EQ(things[1].surface.restitution, 0.5);
  EXPECT_EQ(things[1].surface.friction, Surface{}.friction);
}

TEST(LooseThings, MistakesAreNamed) {
  const auto expect = [](const char* thing, std::initializer_list<const char*> words) {
    const std::string message = input_error([&] {
      read("things:\n  - {node: brick, mass_kg: 0.1, tag: {id: 5, side_m: 0.03, pose: {xyz: [0, 0, 0]}}}\n  - " +
           std::string(thing) + "\n");
    });
    for (const char* word : words) EXPECT_THAT(message, testing::HasSubstr(word)) << thing;
  };
  expect("{node: cup, mass_kg: 0}", {"rig.yaml:3", "mass_kg", "choose from"});
  expect("{node: cup, mass_kg: 90000}", {"mass_kg", "90000"});
  expect("{node: cup, mass_kg: .nan}", {"mass_kg"});
  expect("{node: cup, mass: 1}", {"did you mean 'mass_kg'"});
  expect("{node: brick, mass_kg: 1}", {"'brick' is named twice"});
  expect("{node: cup, mass_kg: 1, restitution: 2}", {"restitution"});
  expect("{node: cup, mass_kg: 1, tag: {id: 5, side_m: 0.03, pose: {xyz: [0, 0, 0]}}}", {"tag 5", "on 'brick' too"});
  expect("{node: cup, mass_kg: 1, tag: {id: 7000, side_m: 0.03, pose: {xyz: [0, 0, 0]}}}", {"id"});
  expect("{node: cup, mass_kg: 1, tag: {id: 6, side_m: 30, pose: {xyz: [0, 0, 0]}}}", {"side_m", "metres"});
  std::string many = "things:\n";
  for (int i = 0; i < 65; ++i) many += "  - {node: t" + std::to_string(i) + ", mass_kg: 1}\n";
  EXPECT_THAT(input_error([&] { read(many); }), testing::HasSubstr("65 things"));
}

}  // namespace
}  // namespace foresight::loose_things_test
