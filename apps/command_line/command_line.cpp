#include "apps/command_line/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <limits>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <type_traits>

#include "common/text.hpp"

namespace foresight {
namespace {

/// What CLI11 says, but for an option without its value: "--size: 1 required TEXT:one of a, b missing".
std::string fault_of(const CLI::ParseError& error) {
  const std::string said = error.what();
  static const std::regex missing("([^ ]+): 1 required [A-Z]+:?(.*) missing");
  std::smatch parts;
  if (!std::regex_match(said, parts, missing)) return said;
  return parts[1].str() + ": its value is missing" + (parts[2].length() > 0 ? "; give " + parts[2].str() : "");
}

/// "there is no option '--delay'; did you mean '--delay-ms'? See `...`". `dashes`: before the given word and all that
/// are known, which are not told apart by them.
std::string no_such(const char* kind, const std::string& dashes, const std::string& given,
                    const std::vector<std::string>& known, const std::string& help) {
  std::string question = question_of_near(given, known);
  if (!question.empty()) question.insert(question.find('\'') + 1, dashes);
  return std::string("there is no ") + kind + " " + in_quotes(dashes + given) + "; " +
         (question.empty() ? help : question + " S" + help.substr(1));
}

std::vector<std::string> options_of(const CLI::App& command) {
  std::vector<std::string> out;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) out.push_back(name);
  return out;
}

// What is wrong with the command line, and what to do about it.
std::string explain(const CLI::App& app, const CLI::ParseError& error) {
  // The command that was meant: `foresight link status` is three deep.
  const CLI::App* command = &app;
  std::string help = "see `foresight ";
  for (auto chosen = app.get_subcommands(); !chosen.empty(); chosen = command->get_subcommands()) {
    command = chosen.front();
    help += command->get_name() + " ";
  }
  help += "--help`";
  std::vector<std::string> jobs;
  for (const CLI::App* job : command->get_subcommands({})) jobs.push_back(job->get_name());
  const auto unknown = app.remaining(true);
  if (!jobs.empty() && !unknown.empty() && !unknown.front().starts_with('-'))
    return no_such("subcommand", "", unknown.front(), jobs, help);
  const auto option = std::ranges::find_if(unknown, [](const std::string& word) { return word.starts_with("--"); });
  if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr) return fault_of(error) + "; " + help;
  if (option == unknown.end()) return "not expected: " + joined(unknown) + "; " + help;
  return no_such("option", "--", option->substr(2, option->find('=') - 2), options_of(*command), help);
}

/// Numbers such as -.6 as -0.6: CLI11 takes them for options.
std::vector<std::string> words_of(int argc, char** argv) {
  std::vector<std::string> words(argv, argv + argc);
  for (std::string& word : words)
    if (word.size() > 2 && word.starts_with("-.") && std::isdigit(static_cast<unsigned char>(word[2])))
      word.insert(1, "0");
  return words;
}

template <typename T>
struct Plain {
  using type = T;
};
template <typename T>
struct Plain<std::optional<T>> {
  using type = T;
};
template <typename T>
struct Plain<std::vector<T>> {
  using type = T;
};

/// "nan" and "inf" are numbers for a parser, and for nobody else.
OptionCheck finite() {
  return {[](const std::string& given) {
            const auto value = parse_number(given);
            return value && std::isfinite(*value) ? std::string()
                                                  : in_quotes(given) + " is not a finite number; give one";
          },
          ""};
}

template <typename T>
OptionCheck whole() {
  return {[](std::string given) {
            if (CLI::TypeValidator<T>()(given).empty()) return std::string();
            const auto number = parse_number(given);
            if (number && *number > static_cast<double>(std::numeric_limits<T>::max()))
              return in_quotes(given) + " is too large; give at most " + std::to_string(std::numeric_limits<T>::max());
            const std::string kind =
                std::is_unsigned_v<T> ? " is not a whole number from 0 on" : " is not a whole number";
            return in_quotes(given) + kind + "; give one";
          },
          ""};
}

}  // namespace

OptionCheck from_to(double low, double high) {
  const auto text = [](double value) {
    std::ostringstream stream;
    stream << std::setprecision(8) << value;
    return stream.str();
  };
  const std::string range = "from " + text(low) + " to " + text(high);
  const auto fault = [low, high, range](const std::string& given) {
    const auto value = parse_number(given);
    return value && *value >= low && *value <= high ? std::string()
                                                    : in_quotes(given) + " is not a number " + range + "; give one";
  };
  return {fault, range};
}

OptionCheck one_of(std::vector<std::string> words) {
  const std::string all = joined(words);
  return {[words = std::move(words), all](const std::string& given) {
            if (std::find(words.begin(), words.end(), given) != words.end()) return std::string();
            const std::string question = question_of_near(given, words);
            return in_quotes(given) + " is none of " + all + "; " + (question.empty() ? "give one" : question);
          },
          "one of " + all};
}

OptionCheck existing_file() {
  return {[](const std::string& given) {
            std::error_code ignored;
            return std::filesystem::is_regular_file(given, ignored) ? std::string()
                                                                    : in_quotes(given) + " is not there, or no file";
          },
          "file"};
}

Option* Option::required() {
  option_->required();
  return this;
}
Option* Option::check(OptionCheck check) {
  option_->check(CLI::Validator(std::move(check.fault), std::move(check.expects)));
  return this;
}
Option* Option::expected(int words) {
  option_->expected(words);
  return this;
}
Option* Option::expected(int least, int most) {
  option_->expected(least, most);
  return this;
}
Option* Option::capture_default_str() {
  option_->capture_default_str();
  return this;
}
Option* Option::default_str(const std::string& text) {
  option_->default_str(text);
  return this;
}
Option* Option::excludes(const Option* other) {
  option_->excludes(other->option_);
  return this;
}
Option* Option::needs(const Option* other) {
  option_->needs(other->option_);
  return this;
}

Option* Option::reads() {
  role_ = OutputsOf();
  option_->type_name("INPUT");
  return this;
}
Option* Option::writes(FileForm form) {
  return writes([form = std::move(form)](const std::filesystem::path& file) -> std::vector<Output> {
    return {{file, Output::Kind::file, form}};
  });
}
Option* Option::writes(OutputsOf outputs) {
  role_ = std::move(outputs);
  option_->type_name("OUTPUT");
  return this;
}

Command::Command(CLI::App& app) : app_(app) {}
Command::~Command() = default;

Command* Command::add_subcommand(const std::string& name, const std::string& help) {
  return &commands_.emplace_back(*app_.add_subcommand(name, help));
}
void Command::require_subcommand() {
  app_.require_subcommand(1);
}
Command* Command::add_option_group(const std::string& name) {
  return &commands_.emplace_back(*app_.add_option_group(name));
}

Option* Command::keep(CLI::Option* option) {
  return &options_.emplace_back(option);
}

template <typename T>
Option* Command::add_option(const std::string& names, T& target, const std::string& help) {
  using Type = typename Plain<T>::type;
  Option* const option = keep(app_.add_option(names, target, help));
  option->is_path_ = std::is_same_v<Type, std::filesystem::path>;
  if constexpr (std::is_same_v<Type, double>) option->check(finite());
  if constexpr (std::is_integral_v<Type>) option->check(whole<Type>());
  return option;
}
template Option* Command::add_option(const std::string&, int&, const std::string&);
template Option* Command::add_option(const std::string&, std::int64_t&, const std::string&);
template Option* Command::add_option(const std::string&, std::uint32_t&, const std::string&);
template Option* Command::add_option(const std::string&, std::uint64_t&, const std::string&);
template Option* Command::add_option(const std::string&, double&, const std::string&);
template Option* Command::add_option(const std::string&, std::string&, const std::string&);
template Option* Command::add_option(const std::string&, std::filesystem::path&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<int>&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<std::uint64_t>&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<long long>&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<double>&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<std::string>&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<std::filesystem::path>&, const std::string&);
template Option* Command::add_option(const std::string&, std::vector<int>&, const std::string&);
template Option* Command::add_option(const std::string&, std::vector<double>&, const std::string&);
template Option* Command::add_option(const std::string&, std::vector<std::string>&, const std::string&);
template Option* Command::add_option(const std::string&, std::vector<std::filesystem::path>&, const std::string&);

Option* Command::add_flag(const std::string& names, bool& target, const std::string& help) {
  // CLI11 would write {false} behind its name.
  if (names.starts_with('!'))
    return keep(app_.add_flag_callback(
        names.substr(1), [&target] { target = false; }, help));
  return keep(app_.add_flag(names, target, help));
}
Option* Command::add_flag(const std::string& names, std::optional<bool>& target, const std::string& help) {
  const bool clears = names.starts_with('!');
  return keep(app_.add_flag_callback(
      clears ? names.substr(1) : names, [&target, clears] { target = !clears; }, help));
}
Option* Command::add_number(const std::string& names, std::function<void(std::uint64_t)> take,
                            const std::string& help) {
  return keep(app_.add_option_function<std::uint64_t>(names, take, help));
}
Option* Command::add_word(const std::string& names, std::vector<std::string> words,
                          std::function<void(const std::string&)> take, const std::string& help) {
  return keep(app_.add_option_function<std::string>(names, take, help))->check(one_of(std::move(words)));
}

void Command::footer(const std::string& text) {
  app_.footer(text);
}
void Command::callback(std::function<void()> then) {
  app_.callback(std::move(then));
}

std::vector<GivenPath> Command::given_paths() const {
  std::vector<GivenPath> out;
  for (const Option& option : options_)
    if (option.role_)
      for (const std::string& word : option.option_->results())
        out.push_back({option.option_->get_name(), word, *option.role_});
  for (const Command& below : commands_)
    if (below.app_.get_name().empty() || below.app_.parsed())
      for (GivenPath& path : below.given_paths()) out.push_back(std::move(path));
  return out;
}

void Command::require_roles() const {
  for (const Option& option : options_)
    if (option.is_path_ && !option.role_)
      throw std::logic_error(app_.get_name() + " " + option.option_->get_name() + " does not say what its path is for");
  for (const Command& below : commands_) below.require_roles();
}

CommandLine read_command_line(int argc, char** argv, const std::string& help, const std::string& version,
                              const std::function<void(Command&)>& define) {
  CLI::App app{help};
  app.set_version_flag("--version", version);
  bool only_check = false;
  app.add_flag("--check-options", only_check, "Only says whether the words behind it can be read, and does nothing");
  Command root(app);
  define(root);
  root.require_roles();
  try {
    const std::vector<std::string> words = words_of(argc, argv);
    std::vector<const char*> pointers;
    for (const std::string& word : words) pointers.push_back(word.c_str());
    app.parse(argc, pointers.data());
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return {app.exit(error), {}};
    std::cerr << "foresight: " << explain(app, error) << "\n";
    return {2, {}};
  }
  if (only_check) return {0, {}};
  return {std::nullopt, root.given_paths()};
}

}  // namespace foresight
