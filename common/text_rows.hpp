// Tables in text files: one row a line, fields between blanks or commas. The one reader of all such files.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace foresight {

/// A row while it is visited; its views end with the visit.
struct TextRow {
  const std::filesystem::path& file;
  int line = 0;                          ///< from 1
  std::vector<std::string_view> fields;  ///< at least one
  std::string_view text{};               ///< the whole line, without its end and the blanks around it
  std::size_t indent = 0;                ///< blanks in front of `text`

  std::string where() const;                   ///< "file:line"
  std::string where(std::size_t field) const;  ///< "file:line:column", in bytes from 1; a row made up has no column
};

struct RowForm {
  enum class Between {
    blanks,  ///< any number of them; no field is empty
    commas,  ///< each one separates; blanks around a field go; CSV's quotes ("a, ""b""") are understood
    loose,   ///< any number of blanks, commas, semicolons and brackets, as programs print matrices; no field is empty
  };
  Between between = Between::blanks;
  bool comments = false;  ///< visit lines that begin with '#', too
};

/// Visits every row of `file`. Lines that are blank are passed over, and those whose first character is '#'; a
/// byte-order mark and CRLF are accepted. Throws InputError: no regular file, larger than 1 GiB; naming file, line and
/// column, a quote that is not closed or has something behind it.
void for_each_row(const std::filesystem::path& file, const RowForm& form,
                  const std::function<void(const TextRow&)>& visit);

/// Field `index` as a finite number. Throws InputError naming file, line, column and `name`.
double finite_field(const TextRow& row, std::size_t index, const std::string& name);

}  // namespace foresight
