#include "common/text_rows.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/error.hpp"
#include "common/read_file.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr std::string_view kBlank = " \t\r\v\f";

void split_runs(TextRow& row, std::string_view between) {
  for (std::size_t at = row.text.find_first_not_of(between); at != std::string_view::npos;) {
    const std::size_t end = std::min(row.text.find_first_of(between, at), row.text.size());
    row.fields.push_back(row.text.substr(at, end - at));
    at = row.text.find_first_not_of(between, end);
  }
}

/// The field between the quotes that begin at `at`; moves `at` behind them. Doubled quotes become one in place.
std::string_view quoted(const TextRow& row, char* line, std::size_t& at) {
  const auto fail = [&](std::size_t column, const char* what) {
    throw InputError(row.where() + ":" + std::to_string(row.indent + column + 1), what,
                     "double a quote that belongs to the text");
  };
  const std::size_t first = at + 1, size = row.text.size();
  std::size_t to = first;
  for (std::size_t from = first; from < size; ++from) {
    if (line[from] != '"') {
      line[to++] = line[from];
    } else if (from + 1 < size && line[from + 1] == '"') {
      line[to++] = line[from++];
    } else {
      at = std::min(row.text.find_first_not_of(kBlank, from + 1), size);
      if (at < size && line[at] != ',') fail(at, "something follows a closing quote");
      return row.text.substr(first, to - first);
    }
  }
  fail(at, "a quote is not closed on its line");
  return {};
}

void split_commas(TextRow& row, char* line) {
  for (std::size_t at = 0;; ++at) {
    const std::size_t first = std::min(row.text.find_first_not_of(kBlank, at), row.text.size());
    if (first < row.text.size() && line[first] == '"') {
      at = first;
      row.fields.push_back(quoted(row, line, at));
    } else {
      const std::size_t end = std::min(row.text.find(',', at), row.text.size());
      row.fields.push_back(trimmed(row.text.substr(at, end - at), kBlank));
      at = end;
    }
    if (at >= row.text.size()) return;
  }
}

}  // namespace

std::string TextRow::where() const {
  return at_line(file, line);
}

std::string TextRow::where(std::size_t field) const {
  const char *at = fields[field].data(), *first = text.data();
  if (std::less{}(at, first) || std::less{}(first + text.size(), at)) return where();
  return where() + ":" + std::to_string(at - first + indent + 1);
}

void for_each_row(const std::filesystem::path& file, const RowForm& form,
                  const std::function<void(const TextRow&)>& visit) {
  std::string content = read_file(file, kLargestTable);
  const std::string_view all = content;
  std::size_t at = all.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  for (TextRow row{file, 1, {}}; at < all.size(); ++row.line) {
    const std::size_t end = std::min(all.find('\n', at), all.size());
    const std::string_view line = all.substr(at, end - at);
    row.text = trimmed(line, kBlank);
    row.indent = std::min(line.find_first_not_of(kBlank), line.size());
    at = end + 1;
    row.fields.clear();
    if (row.text.empty() || (row.text[0] == '#' && !form.comments)) continue;
    switch (form.between) {
      case RowForm::Between::blanks: split_runs(row, kBlank); break;
      case RowForm::Between::commas: split_commas(row, content.data() + (row.text.data() - all.data())); break;
      case RowForm::Between::loose: split_runs(row, " \t\r\v\f,;[]"); break;
    }
    if (!row.fields.empty()) visit(row);
  }
}

double finite_field(const TextRow& row, std::size_t index, const std::string& name) {
  const auto value = parse_number(row.fields[index]);
  if (!value || !std::isfinite(*value))
    throw InputError(row.where(index), name + " is " + in_quotes(row.fields[index]) + ", not a finite number",
                     "correct or remove the line");
  return *value;
}

}  // namespace foresight
