#include "calibration/target/corner_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>

#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/files.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> fields_of(std::string_view line, std::string_view separators, bool keep_empty) {
  std::vector<std::string> fields;
  while (true) {
    const std::size_t end = std::min(line.find_first_of(separators), line.size());
    std::string_view field = line.substr(0, end);
    while (!field.empty() && std::isspace(static_cast<unsigned char>(field.front()))) field.remove_prefix(1);
    while (!field.empty() && std::isspace(static_cast<unsigned char>(field.back()))) field.remove_suffix(1);
    if (keep_empty || !field.empty()) fields.emplace_back(field);
    if (end == line.size()) return fields;
    line.remove_prefix(end + 1);
  }
}

void for_each_line(const fs::path& file, const std::function<void(std::string_view, int)>& visit) {
  const std::string content = read_file(file);
  std::string_view rest = content;
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
  for (int line = 1; !rest.empty(); ++line) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view text = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.remove_suffix(1);
    if (!text.empty()) visit(text, line);
  }
}

double finite(const std::string& text, const std::string& where, const std::string& what) {
  const auto value = parse_number(text);
  if (!value || !std::isfinite(*value))
    throw InputError(where, what + " is " + in_quotes(text) + ", not a finite number", "correct or remove it");
  return *value;
}

class VnlReader {
 public:
  VnlReader(const fs::path& file, std::size_t points) : file_(file), points_(points) {}

  std::vector<VnlImage> read() {
    for_each_line(file_, [this](std::string_view text, int line) {
      if (text.starts_with("##")) return;
      if (text.starts_with("#"))
        legend(text.substr(1), line);
      else
        row(fields_of(text, " \t", false), line);
    });
    finish_image();
    if (images_.empty()) throw InputError(file_.string(), "holds no row", "write lines: filename x y level");
    return std::move(images_);
  }

 private:
  void legend(std::string_view text, int line) {
    if (columns_ != 0) return;
    const auto names = fields_of(text, " \t", false);
    static const std::vector<std::string> kKnown{"filename", "x", "y"};
    const bool known =
        names.size() >= 3 && names.size() <= 4 && std::equal(kKnown.begin(), kKnown.end(), names.begin());
    if (!known || (names.size() == 4 && names[3] != "level" && names[3] != "weight"))
      throw InputError(at_line(file_, line), "has columns " + in_quotes(text), "write '# filename x y level'");
    columns_ = names.size();
    weights_ = columns_ == 4 && names[3] == "weight";
  }

  void row(const std::vector<std::string>& fields, int line) {
    const std::string where = at_line(file_, line);
    if (fields.size() < 3 || fields.size() > 4)
      throw InputError(where, "has " + std::to_string(fields.size()) + " fields", "write: filename x y level");
    if (images_.empty() || images_.back().name != fields[0]) start_image(fields[0], where, line);
    VnlImage& image = images_.back();
    const std::size_t index = rows_++;
    if (fields[1] == "-" || fields[2] == "-" || (fields.size() == 4 && fields[3] == "-")) return;
    if (index >= points_) refuse_count(where, index + 1, " or more");
    const std::string what = " of corner " + std::to_string(index) + " of " + image.name;
    Corner corner{
        static_cast<int>(index), {finite(fields[1], where, "x" + what), finite(fields[2], where, "y" + what)}, 1};
    if (fields.size() == 4) {
      const double quality = finite(fields[3], where, (weights_ ? "the weight" : "the level") + what);
      if (quality < 0 || (weights_ && quality == 0)) return;
      corner.sigma_px = weights_ ? 1 / quality : std::exp2(quality);
    }
    image.corners.push_back(corner);
  }

  void start_image(const std::string& name, const std::string& where, int line) {
    finish_image();
    if (!names_.insert(name).second)
      throw InputError(where, in_quotes(name) + " comes a second time", "keep the rows of an image together, once");
    images_.push_back({name, line, {}});
    rows_ = 0;
  }

  void finish_image() {
    if (images_.empty() || rows_ == points_) return;
    if (rows_ == 1 && images_.back().corners.empty()) return;  // an image without the board
    refuse_count(at_line(file_, images_.back().line), rows_, "");
  }

  [[noreturn]] void refuse_count(const std::string& where, std::size_t rows, const std::string& more) const {
    throw InputError(where,
                     images_.back().name + " has " + std::to_string(rows) + more + " rows, the board " +
                         std::to_string(points_) + " points",
                     "check --board; write '-' for a point that was not seen");
  }

  const fs::path& file_;
  std::size_t points_, columns_ = 0, rows_ = 0;
  bool weights_ = false;
  std::vector<VnlImage> images_;
  std::set<std::string> names_;
};

constexpr std::array<const char*, 12> kTagColumns{"ts",          "tag_rows", "tag_cols", "tag_size",
                                                  "tag_spacing", "kp_x",     "kp_y",     "p_x",
                                                  "p_y",         "p_z",      "tag_id",   "corner_idx"};

/// Where each of kTagColumns stands in the file.
std::vector<std::size_t> tag_columns(std::vector<std::string> header, const std::string& where) {
  if (!header.empty() && header[0].starts_with("#")) header[0] = fields_of(header[0].substr(1), ",", true)[0];
  const std::vector<std::string> known(kTagColumns.begin(), kTagColumns.end());
  for (const std::string& name : header)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw InputError(where, "has an unknown column " + in_quotes(name),
                       "did you mean " + nearest_word(name, known) + "?");
  std::vector<std::size_t> at;
  for (const std::string& name : known) {
    if (std::count(header.begin(), header.end(), name) != 1)
      throw InputError(where, "needs the column " + name + " once", "write the twelve columns ts,...,corner_idx");
    at.push_back(static_cast<std::size_t>(std::find(header.begin(), header.end(), name) - header.begin()));
  }
  return at;
}

long long whole(const std::string& text, const std::string& where, const char* name) {
  const double value = finite(text, where, name);
  if (value != std::floor(value) || std::abs(value) > 1e9)
    throw InputError(where, std::string(name) + " is " + in_quotes(text) + ", not a whole number", "correct it");
  return static_cast<long long>(value);
}

}  // namespace

std::vector<VnlImage> read_vnl(const fs::path& file, std::size_t points) {
  return VnlReader(file, points).read();
}

std::vector<TagRow> read_tag_table(const fs::path& file) {
  std::vector<TagRow> rows;
  std::vector<std::size_t> at;
  for_each_line(file, [&](std::string_view text, int line) {
    const std::string where = at_line(file, line);
    const auto fields = fields_of(text, ",", true);
    if (at.empty() && !parse_number(fields[0])) {
      at = tag_columns(fields, where);
      return;
    }
    if (text.starts_with("#")) return;
    if (at.empty())
      for (std::size_t i = 0; i < kTagColumns.size(); ++i) at.push_back(i);
    if (fields.size() != at.size())
      throw InputError(where, "has " + std::to_string(fields.size()) + " fields", "write 12, with commas between");
    const auto text_of = [&](std::size_t column) -> const std::string& { return fields[at[column]]; };
    TagRow row{where, whole(text_of(10), where, "tag_id"), whole(text_of(11), where, "corner_idx"), {}, {}};
    const std::string corner = " of corner " + std::to_string(row.corner) + " of tag " + std::to_string(row.tag);
    const auto number = [&](std::size_t column) {
      return finite(text_of(column), where, kTagColumns[column] + corner);
    };
    row.pixel = {number(5), number(6)};
    row.p_board = {number(7), number(8), number(9)};
    rows.push_back(std::move(row));
  });
  return rows;
}

}  // namespace foresight
