#include "calibration/target/corner_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "common/text_rows.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

class VnlReader {
 public:
  VnlReader(const fs::path& file, std::size_t points) : file_(file), points_(points) {}

  std::vector<VnlImage> read() {
    for_each_row(file_, {RowForm::Between::blanks, true}, [this](const TextRow& row) {
      if (row.text.starts_with("##")) return;
      if (row.text.starts_with("#"))
        legend(row);
      else
        read_row(row);
    });
    finish_image();
    if (images_.empty()) throw InputError(file_.string(), "holds no row", "write lines: filename x y level");
    return std::move(images_);
  }

 private:
  void legend(const TextRow& row) {
    if (columns_ != 0) return;
    auto names = row.fields;
    names[0].remove_prefix(1);  // the sign may stand by itself or not
    if (names[0].empty()) names.erase(names.begin());
    static constexpr std::array<std::string_view, 3> kKnown{"filename", "x", "y"};
    const bool known =
        names.size() >= 3 && names.size() <= 4 && std::equal(kKnown.begin(), kKnown.end(), names.begin());
    if (!known || (names.size() == 4 && names[3] != "level" && names[3] != "weight"))
      throw InputError(row.where(), "has columns " + in_quotes(row.text.substr(1)), "write '# filename x y level'");
    columns_ = names.size();
    weights_ = columns_ == 4 && names[3] == "weight";
  }

  void read_row(const TextRow& row) {
    const auto& fields = row.fields;
    if (fields.size() < 3 || fields.size() > 4)
      throw InputError(row.where(), "has " + counted(fields.size(), "field"), "write: filename x y level");
    if (images_.empty() || images_.back().name != fields[0]) start_image(std::string(fields[0]), row.where(), row.line);
    VnlImage& image = images_.back();
    const std::size_t index = rows_++;
    if (fields[1] == "-" || fields[2] == "-" || (fields.size() == 4 && fields[3] == "-")) return;
    if (index >= points_) refuse_count(row.where(), index + 1, " or more");
    const std::string what = " of corner " + std::to_string(index) + " of " + image.name;
    Corner corner{static_cast<int>(index), {finite_field(row, 1, "x" + what), finite_field(row, 2, "y" + what)}, 1};
    if (fields.size() == 4) {
      const double quality = finite_field(row, 3, (weights_ ? "the weight" : "the level") + what);
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
    throw InputError(
        where,
        images_.back().name + " has " + std::to_string(rows) + more + " rows, the board " + counted(points_, "point"),
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
std::vector<std::size_t> tag_columns(const TextRow& row) {
  auto header = row.fields;
  if (header[0].starts_with("#"))
    header[0].remove_prefix(std::min(header[0].find_first_not_of("# \t"), header[0].size()));
  const std::vector<std::string> known(kTagColumns.begin(), kTagColumns.end());
  for (std::size_t i = 0; i < header.size(); ++i)
    if (std::find(known.begin(), known.end(), header[i]) == known.end())
      throw InputError(row.where(i), "has an unknown column " + in_quotes(header[i]), did_you_mean(header[i], known));
  std::vector<std::size_t> at;
  for (const std::string& name : known) {
    if (std::count(header.begin(), header.end(), name) != 1)
      throw InputError(row.where(), "needs the column " + name + " once", "write the twelve columns ts,...,corner_idx");
    at.push_back(static_cast<std::size_t>(std::find(header.begin(), header.end(), name) - header.begin()));
  }
  return at;
}

long long whole(const TextRow& row, std::size_t column, const char* name) {
  const double value = finite_field(row, column, name);
  if (value != std::floor(value) || std::abs(value) > 1e9)
    throw InputError(row.where(column),
                     std::string(name) + " is " + in_quotes(row.fields[column]) + ", not a whole number", "correct it");
  return static_cast<long long>(value);
}

}  // namespace

std::vector<VnlImage> read_vnl(const fs::path& file, std::size_t points) {
  return VnlReader(file, points).read();
}

std::vector<TagRow> read_tag_table(const fs::path& file) {
  std::vector<TagRow> rows;
  std::vector<std::size_t> at;
  for_each_row(file, {RowForm::Between::commas, true}, [&](const TextRow& row) {
    if (at.empty() && !parse_number(row.fields[0])) {
      at = tag_columns(row);
      return;
    }
    if (row.text.starts_with("#")) return;
    if (at.empty())
      for (std::size_t i = 0; i < kTagColumns.size(); ++i) at.push_back(i);
    if (row.fields.size() != at.size())
      throw InputError(row.where(), "has " + counted(row.fields.size(), "field"), "write 12, with commas between");
    TagRow out{row.where(), whole(row, at[10], "tag_id"), whole(row, at[11], "corner_idx"), {}, {}};
    const std::string corner = " of corner " + std::to_string(out.corner) + " of tag " + std::to_string(out.tag);
    const auto number = [&](std::size_t column) { return finite_field(row, at[column], kTagColumns[column] + corner); };
    out.pixel = {number(5), number(6)};
    out.p_board = {number(7), number(8), number(9)};
    rows.push_back(std::move(out));
  });
  return rows;
}

}  // namespace foresight
