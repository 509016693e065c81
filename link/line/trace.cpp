#include "link/line/trace.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "common/error.hpp"
#include "common/read_file.hpp"
#include "common/text.hpp"
#include "common/text_rows.hpp"

namespace foresight {
namespace {

constexpr double kLargestDelay_ms = 600'000;
constexpr long long kLargestTime_ms = 1'000'000'000;  // 11 days
constexpr std::size_t kMostRows = 50'000'000;

const char* const kForms =
    "give a packet-delivery trace (one integer a line, in ms), or a CSV file with the columns time_s,up_kbps,down_kbps "
    "or time_s,up_delay_ms,up_loss,down_delay_ms,down_loss";

Duration milliseconds(double ms) {
  return seconds(ms * 1e-3);
}

/// The shared checks of both CSV forms.
class CsvRows {
 public:
  explicit CsvRows(std::vector<std::string> columns) : columns_(std::move(columns)) {}

  /// Column `index` of the row, within 0 .. `most`.
  double field(const TextRow& row, std::size_t index, double most) const {
    const double value = finite_field(row, index, columns_[index]);
    if (value < 0 || value > most)
      throw InputError(row.where(index), columns_[index] + " is " + in_quotes(row.fields[index]),
                       "give a number from 0 to " + readable(most, 0));
    return value;
  }

  /// Column `index`, kbps.
  double rate(const TextRow& row, std::size_t index) const {
    const double value = field(row, index, kHighestRate_kbps);
    if (value > 0 && value < kLowestRate_kbps)
      throw InputError(row.where(index), columns_[index] + " is " + in_quotes(row.fields[index]),
                       "give 0 where the line stands still, else 0.001 to 1e9 kbps");
    return value;
  }

  void add_time(const TextRow& row) {
    if (row.fields.size() != columns_.size())
      throw InputError(
          row.where(),
          "the row has " + std::to_string(row.fields.size()) + " fields, its header " + std::to_string(columns_.size()),
          "give every row a field for each column");
    const std::optional<Duration> time = parse_seconds(row.fields[0]);
    if (!time) throw InputError(row.where(0), "time_s is " + in_quotes(row.fields[0]), "give seconds");
    if (at_.empty()) first_ = *time;
    if (!at_.empty() && *time - first_ <= at_.back())
      throw InputError(row.where(), "the times do not increase", "sort the rows by time_s");
    at_.push_back(*time - first_);
    if (at_.size() > kMostRows) throw InputError(row.where(), "the trace is too long", "give a part of it");
  }

  /// Of the rows that came; the last one lasts as long as the one before it.
  Duration period(const std::filesystem::path& file) const {
    if (at_.size() < 2) throw InputError(file.string(), "the trace has fewer than two rows", kForms);
    const Duration out = at_.back() + (at_.back() - at_[at_.size() - 2]);
    if (out < kShortestPeriod)
      throw InputError(file.string(), "the trace lasts less than 1 ms, after which it repeats",
                       "write time_s in seconds");
    return out;
  }
  const std::vector<Duration>& at() const { return at_; }

 private:
  std::vector<std::string> columns_;
  Duration first_{};
  std::vector<Duration> at_;
};

bool flag(const TextRow& row, std::size_t index) {
  if (row.fields[index] == "0") return false;
  if (row.fields[index] == "1") return true;
  throw InputError(row.where(index), "a loss is " + in_quotes(row.fields[index]), "give 0 or 1");
}

/// CSV rows behind a header; `begin` looks at the header and chooses what takes the rows.
void for_each_csv_row(const std::filesystem::path& file, const std::vector<std::string>& columns, CsvRows& rows,
                      const std::function<void(const TextRow&)>& visit) {
  bool header = true;
  for_each_row(file, {.between = RowForm::Between::commas}, [&](const TextRow& row) {
    if (!header) {
      rows.add_time(row);
      visit(row);
      return;
    }
    header = false;
    if (!std::equal(row.fields.begin(), row.fields.end(), columns.begin(), columns.end()))
      throw InputError(row.where(), "these are not the columns of a line's trace", kForms);
  });
}

LineTraces read_packets(const std::filesystem::path& file) {
  const std::vector<std::string> columns = {"time_s", "up_delay_ms", "up_loss", "down_delay_ms", "down_loss"};
  CsvRows rows(columns);
  std::array<PacketTrace, 2> ways;
  for_each_csv_row(file, columns, rows, [&](const TextRow& row) {
    for (std::size_t way = 0; way < 2; ++way) {
      ways[way].delay.push_back(milliseconds(rows.field(row, 1 + 2 * way, kLargestDelay_ms)));
      ways[way].lost.push_back(flag(row, 2 + 2 * way));
    }
  });
  for (PacketTrace& way : ways) {
    way.period = rows.period(file);
    way.at = rows.at();
    if (std::find(way.lost.begin(), way.lost.end(), false) == way.lost.end())
      throw InputError(file.string(), "every packet of one direction is lost",
                       "give a trace of a line that carries any");
  }
  return {std::make_shared<const Trace>(ways[0]), std::make_shared<const Trace>(ways[1])};
}

LineTraces read_rates(const std::filesystem::path& file) {
  const std::vector<std::string> columns = {"time_s", "up_kbps", "down_kbps"};
  CsvRows rows(columns);
  std::array<RateTrace, 2> ways;
  for_each_csv_row(file, columns, rows, [&](const TextRow& row) {
    for (std::size_t way = 0; way < 2; ++way) ways[way].bytes_per_s.push_back(rows.rate(row, 1 + way) * 125);
  });
  for (RateTrace& way : ways) {
    way.period = rows.period(file);
    way.at = rows.at();
    if (*std::max_element(way.bytes_per_s.begin(), way.bytes_per_s.end()) <= 0)
      throw InputError(file.string(), "one direction never carries anything", "give rates above 0");
  }
  return {std::make_shared<const Trace>(ways[0]), std::make_shared<const Trace>(ways[1])};
}

LineTraces read_deliveries(const std::filesystem::path& file) {
  DeliveryTrace trace;
  for_each_row(file, {}, [&](const TextRow& row) {
    const std::optional<long long> ms = row.fields.size() == 1 ? parse_integer(row.fields[0]) : std::nullopt;
    if (!ms || *ms < 0 || *ms > kLargestTime_ms)
      throw InputError(row.where(), in_quotes(row.text) + " is no time in ms", kForms);
    if (!trace.at_ms.empty() && *ms < static_cast<long long>(trace.at_ms.back()))
      throw InputError(row.where(), "the times are not sorted", "sort the lines by number");
    if (trace.at_ms.size() >= kMostRows) throw InputError(row.where(), "the trace is too long", "give a part of it");
    trace.at_ms.push_back(static_cast<std::uint32_t>(*ms));
  });
  if (trace.at_ms.empty()) throw InputError(file.string(), "the trace is empty", kForms);
  if (trace.at_ms.back() == 0)
    throw InputError(file.string(), "the trace lasts 0 ms", "end it with the time at which it repeats, above 0");
  return {std::make_shared<const Trace>(std::move(trace)), nullptr};
}

/// What stands first in the file.
std::string first_row(const std::filesystem::path& file) {
  std::ifstream in = open_input(file, kLargestTable);
  for (std::string line; std::getline(in, line);)
    if (line.find_first_not_of(" \t\r") != std::string::npos && line.front() != '#') return line;
  return {};
}

}  // namespace

LineTraces read_line_traces(const std::filesystem::path& file) {
  const std::string first = first_row(file);
  if (first.find(',') == std::string::npos) return read_deliveries(file);
  return first.find("kbps") != std::string::npos ? read_rates(file) : read_packets(file);
}

Duration period_of(const Trace& trace) {
  if (const auto* deliveries = std::get_if<DeliveryTrace>(&trace))
    return std::chrono::milliseconds(deliveries->at_ms.back());
  if (const auto* packets = std::get_if<PacketTrace>(&trace)) return packets->period;
  return std::get<RateTrace>(trace).period;
}

}  // namespace foresight
