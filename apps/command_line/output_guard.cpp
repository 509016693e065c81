#include "apps/command_line/output_guard.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <set>

#include "apps/command_line/inputs.hpp"
#include "common/error.hpp"
#include "common/partial_path.hpp"
#include "common/plot_data.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;
using Kind = Output::Kind;

/// An output with all that is asked about it more than once.
struct Place {
  std::string option, where;
  Output output;
  fs::path canonical;  // without links and dots, as far as it exists
  fs::file_status status;
  bool is_folder() const { return output.kind == Kind::folder || output.kind == Kind::replaced_folder; }
  bool is_there() const { return fs::exists(status); }
};

Place place_of(const std::string& option, Output output) {
  std::error_code ignored;
  Place out;
  out.option = option;
  out.where = option + " " + output.path.string();
  out.canonical = canonical_place(output.path);
  out.status = fs::status(output.path, ignored);
  out.output = std::move(output);
  return out;
}

std::vector<Place> places_of(const std::vector<GivenPath>& given) {
  std::vector<Place> out;
  for (const GivenPath& path : given)
    if (path.outputs)
      for (Output& output : path.outputs(path.word)) out.push_back(place_of(path.option, std::move(output)));
  return out;
}

void require_words(const std::vector<GivenPath>& given) {
  for (const GivenPath& path : given) {
    if (path.word.empty())
      throw InputError(path.option, "is an empty name",
                       path.outputs ? "name what to write, or leave it out" : "name what to read, or leave it out");
    if (path.word == "-" && path.outputs)  // of many other programs: standard output
      throw InputError(path.option + " -", "would be a file that is called '-'",
                       "name a file; /dev/stdout is the standard output, ./- that file");
  }
}

/// What is there is of the right kind.
void require_kind(const Place& place) {
  const bool folder_there = fs::is_directory(place.status);
  if (place.is_folder()) {
    if (place.is_there() && !folder_there)
      throw InputError(place.where, "exists and is not a folder", "give another place");
    return;
  }
  if (place.output.kind == Kind::either) return;
  if (folder_there || !place.output.path.has_filename())
    throw InputError(place.where, "this is a folder", "give a file name");
  if (fs::is_block_file(place.status) || fs::is_socket(place.status))
    throw InputError(place.where, "is a disk or a socket", "give a file name");
}

void require_two_places(const Place& a, const Place& b) {
  if (fs::is_character_file(a.status)) return;  // /dev/null takes all
  if (same_file(a.canonical, b.canonical))
    throw InputError(
        b.where,
        a.option == b.option ? "and " + a.output.path.string() + " are one file" : "is the file of " + a.option,
        "give each its own name");
  const auto swallows = [](const Place& outer, const Place& inner) {
    return outer.output.kind == Kind::replaced_folder && lies_in(outer.canonical, inner.canonical);
  };
  if (swallows(a, b) || swallows(b, a))
    throw InputError(b.where, "and " + a.where + " share a folder, and the whole of it is replaced",
                     "give each a folder of its own");
}

void require_not_an_input(const Place& place, const Inputs& inputs) {
  const bool marked = place.output.form && place.output.form->marked && place.is_there() &&
                      has_form(place.output.path, *place.output.form);
  if (const auto input = inputs.find(place.canonical, marked))
    throw InputError(place.where, "would overwrite " + *input + ", which is read", "give another place");
  if (!place.is_folder()) return;
  if (const auto input = inputs.find_below(place.canonical, place.output.kind == Kind::replaced_folder))
    throw InputError(place.where, "would overwrite the folder of " + *input + ", which is read", "give another place");
}

void require_ours(const Place& place) {
  if (!place.is_there()) return;
  if (place.output.refuse_foreign) place.output.refuse_foreign(place.where, place.output.path);
  if (!place.is_folder() && fs::is_regular_file(place.status)) {
    if (place.output.form && !has_form(place.output.path, *place.output.form))
      throw InputError(place.where, "exists and is not " + place.output.form->name,
                       "give another place, or remove it first");
    if ((place.status.permissions() & (fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write)) ==
        fs::perms::none)
      throw InputError(place.where, "exists and is write-protected", "give another place, or change its rights");
  }
}

}  // namespace

Output new_output(const fs::path& path, Kind kind) {
  const auto refuse = [](const std::string& where, const fs::path& there) {
    std::error_code ignored;
    if (!fs::is_empty(there, ignored))
      throw InputError(where, "is there already", "give another name, or remove it first");
  };
  return {path, kind, {}, refuse};
}

std::vector<Output> page_outputs(const fs::path& page) {
  std::vector<Output> out{{page, Kind::file, page_form()}};
  if (const auto data = plot_data_file(page)) out.push_back({*data, Kind::file, numbers_form()});
  return out;
}

OutputGuard::OutputGuard(const std::vector<GivenPath>& given) {
  require_words(given);
  const std::vector<Place> places = places_of(given);
  if (places.empty()) return;
  for (const Place& place : places) require_kind(place);
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) require_two_places(places[j], places[i]);
  if (std::ranges::any_of(places, &Place::is_there)) {
    const Inputs inputs(given);
    for (const Place& place : places) require_not_an_input(place, inputs);
    for (const Place& place : places) require_ours(place);
  }
  for (const Place& place : places)
    open_.push_back(require_writable(place.where, place.output.path, place.output.kind == Kind::folder, folders_));
  for (const Place& place : places) {
    if (place.is_there() && !place.is_folder() && !fs::is_regular_file(place.status)) continue;
    locks_.emplace_back(place.where, place.canonical);
    sweep_partials(place.canonical);
    if (place.is_folder()) sweep_partials_in(place.canonical);
  }
}

}  // namespace foresight
