#include "apps/level_options.hpp"

#include "common/error.hpp"

namespace foresight {
namespace {

const Choices<LevelRule>& level_rules() {
  static const Choices<LevelRule> rules{{"full", LevelRule::full},
                                        {"size", LevelRule::by_size},
                                        {"acuity", LevelRule::by_acuity},
                                        {"reactive", LevelRule::reactive},
                                        {"predictive", LevelRule::predictive}};
  return rules;
}

}  // namespace

void add_level_options(Command& command, LevelArguments& arguments) {
  command.add_choice("--detail", arguments.rule, level_rules(),
                     "How finely the model is drawn (default full): as its size in the view needs (size), or\n"
                     "as an eye sees that looks ahead (acuity); or so that drawing it takes no longer than\n"
                     "--detail-budget-ms, by the last frames' time (reactive) or by what each part will cost\n"
                     "and give (predictive)");
  command
      .add_option("--detail-budget-ms", arguments.budget_ms,
                  "With --detail reactive or predictive: milliseconds for the model in each frame,\n"
                  "pixels' colours aside")
      ->check(from_to(0.5, 1e4));
}

std::optional<LevelSettings> level_settings(const LevelArguments& arguments) {
  const bool by_time = arguments.rule == LevelRule::reactive || arguments.rule == LevelRule::predictive;
  if (by_time && !arguments.budget_ms)
    throw InputError("--detail " + to_string(arguments.rule), "there is no time to keep to",
                     "say how long drawing the model may take, such as --detail-budget-ms 20");
  if (!by_time && arguments.budget_ms)
    throw InputError("--detail-budget-ms", "nothing keeps to it",
                     "give it with --detail predictive or --detail reactive");
  if (arguments.rule == LevelRule::full) return std::nullopt;
  LevelSettings out;
  out.rule = arguments.rule;
  out.budget_ms = arguments.budget_ms.value_or(0);
  return out;
}

std::string to_string(LevelRule rule) {
  for (const auto& [word, value] : level_rules())
    if (value == rule) return word;
  return "full";
}

}  // namespace foresight
