#include "apps/robot/session_report.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "calibration/result/html_report.hpp"
#include "common/svg_plot.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

using Doing = SessionRecord::Doing;
using Column = SessionRecord::Column;
using JointColumn = SessionRecord::JointColumn;

struct Band {
  const char* css_class;
  const char* name;
};
Band band_of(Doing doing) {
  switch (doing) {
    case Doing::nothing: return {"c-none", "disabled, or being enabled"};
    case Doing::ready: return {"c-uncoloured", "ready"};
    case Doing::homing: return {"k2", "homing"};
    case Doing::following: return {"c-filled", "following"};
    case Doing::held: return {"k5", "held back"};
    case Doing::stopping: return {"k6", "slowing down"};
    case Doing::stopped: return {"k7", "stopped"};
  }
  return {"c-none", "?"};
}

class SessionPage {
 public:
  SessionPage(const Rig& rig, const SessionRecord& record)
      : rig_(rig), record_(record), page_("Session of " + rig.name, "foresight robot") {
    for (const Column& column : record.columns()) times_.push_back(column.time_s);
  }

  HtmlReport& page() { return page_; }

  void add_overview() {
    std::vector<double> speed;
    for (const Column& column : record_.columns()) speed.push_back(100 * column.speed);
    SvgPlot plot("Speed of the fastest joint, and what the safety gate did", times(), {0, 125}, "s", "% of its limit");
    add_bands(plot, {108, 125});
    plot.line(times_, speed, "s-predicted", "fastest joint");
    page_.plot("Speed of the fastest joint, and what the safety gate did", plot, keys({{"s-predicted", "speed"}}));
    add_bus_load();
  }

  void add_stretches() {
    std::vector<std::vector<std::string>> rows;
    for (const SessionRecord::Stretch& s : record_.stretches())
      rows.push_back({readable(s.from_s, 2, " s"), readable(s.to_s - s.from_s, 2, " s"), s.name, s.cure});
    page_.table({"from", "for", "what the robot did", "what to do"}, rows);
  }

  void add_joint(std::size_t joint) {
    const RigJoint& rigged = rig_.joints[joint];
    page_.heading(rigged.drive.name);
    const auto position = series(joint, &JointColumn::position), asked = series(joint, &JointColumn::set_point);
    const std::string& name = rigged.drive.name;
    add_plot(name + ": position and set-point", rigged.unit,
             {{"asked for", "k5", series(joint, &JointColumn::asked)},
              {"set-point", "s-delayed", asked},
              {"position", "s-predicted", position}},
             {rigged.drive.min_position, rigged.drive.max_position}, {"min", "max"});
    const double allowed = rigged.following_error;
    add_plot(name + ": following error", rigged.unit,
             {{"position less set-point", "s-predicted", series(joint, &JointColumn::error)}}, {-allowed, allowed},
             {"stops the robot", "stops the robot"});
    const double fastest = rigged.drive.max_velocity;
    add_plot(name + ": velocity", rigged.unit + "/s",
             {{"measured", "s-predicted", series(joint, &JointColumn::velocity)}}, {-fastest, fastest},
             {"limit", "limit"});
  }

 private:
  struct Line {
    std::string name;
    const char* css_class;
    std::vector<double> values;
  };

  SvgPlot::Range times() const { return {0, std::max(record_.duration_s(), 1e-3)}; }

  std::vector<double> series(std::size_t joint, double JointColumn::*member) const {
    std::vector<double> out;
    for (const Column& column : record_.columns()) out.push_back(column.joints[joint].*member);
    return out;
  }

  void add_bands(SvgPlot& plot, SvgPlot::Range y) const {
    for (const SessionRecord::Stretch& s : record_.stretches())
      plot.bar({s.from_s, s.to_s}, y, band_of(s.doing).css_class,
               std::string(band_of(s.doing).name) + (s.reason == GateReason::none ? "" : ": " + s.name));
  }

  /// Of lines, and of what the robot did in this session.
  std::vector<PlotKey> keys(std::vector<PlotKey> out) const {
    for (int i = 0; i <= static_cast<int>(Doing::stopped); ++i) {
      const auto doing = static_cast<Doing>(i);
      if (std::ranges::any_of(record_.stretches(), [&](const auto& s) { return s.doing == doing; }))
        out.push_back({band_of(doing).css_class, band_of(doing).name});
    }
    return out;
  }

  /// Limits are drawn where lines come near them; a limit far away would press the lines flat.
  void add_plot(const std::string& title, const std::string& unit, const std::vector<Line>& lines,
                SvgPlot::Range limits, std::array<const char*, 2> names) {
    double least = INFINITY, most = -INFINITY;
    for (const Line& line : lines)
      for (const double v : line.values)
        if (std::isfinite(v)) least = std::min(least, v), most = std::max(most, v);
    if (least > most) least = 0, most = 0;
    const double room = limits.max - limits.min;
    const bool near_min = least<limits.min + 0.15 * room, near_max = most> limits.max - 0.15 * room;
    if (near_min) least = std::min(least, limits.min);
    if (near_max) most = std::max(most, limits.max);
    const double span = std::max(most - least, 0.05 * room);  // noise at rest is no event
    const SvgPlot::Range y{least - 0.06 * span, most + 0.2 * span};
    SvgPlot plot(title, times(), y, "s", unit);
    add_bands(plot, {y.max - 0.05 * (y.max - y.min), y.max});
    std::vector<PlotKey> legend;
    for (const Line& line : lines) {
      plot.line(times_, line.values, line.css_class, line.name);
      legend.push_back({line.css_class, line.name});
    }
    if (near_min) plot.mark_y(limits.min, names[0], "m-strong");
    if (near_max) plot.mark_y(limits.max, names[1], "m-strong");
    page_.plot(title, plot, legend);
  }

  void add_bus_load() {
    SvgPlot plot("Load of the buses", times(), {0, 105}, "s", "% of the bit rate");
    std::vector<PlotKey> legend;
    constexpr std::array<const char*, 4> kColours{"s-predicted", "s-delayed", "k3", "k7"};
    for (std::size_t bus = 0; bus < rig_.buses.size(); ++bus) {
      std::vector<double> load;
      for (const Column& column : record_.columns())
        load.push_back(bus < column.load.size() ? 100 * column.load[bus] : NAN);
      const char* const colour = kColours[bus % kColours.size()];
      plot.line(times_, load, colour, rig_.buses[bus].name);
      legend.push_back({colour, rig_.buses[bus].name});
    }
    page_.plot("Load of the buses", plot, legend);
  }

  const Rig& rig_;
  const SessionRecord& record_;
  HtmlReport page_;
  std::vector<double> times_;
};

}  // namespace

void write_session_report(const std::filesystem::path& file, const Rig& rig, const SessionRecord& record,
                          const std::string& verdict, const std::vector<SessionFact>& facts) {
  SessionPage page(rig, record);
  page.page().paragraph(verdict);
  page.add_overview();
  page.add_stretches();
  for (std::size_t i = 0; i < rig.joints.size(); ++i) page.add_joint(i);
  page.page().heading("Session");
  std::vector<std::vector<std::string>> rows;
  for (const SessionFact& fact : facts) rows.push_back({fact.name, fact.value});
  page.page().table({"what", "value"}, rows);
  page.page().paragraph(
      "The bands show what the safety gate did. Where many cycles share a column, position and set-point are the last, "
      "following error, velocity and load the largest of them. The following error is the position that a drive told "
      "in a "
      "cycle, less the set-point that it was to have reached by then.");
  page.page().write(file);
}

}  // namespace foresight
