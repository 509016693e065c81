#include "calibration/target/print_board.hpp"
#include "calibration/tags/tag_family.hpp"

#include <cairo-pdf.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "calibration/target/board_drawing.hpp"
#include "common/atomic_file.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr double kPointsPerMm = 72 / 25.4;
constexpr double kRimMm = 8;     // what printers cannot reach, and a little
constexpr double kStripMm = 14;  // for a ruler, left and below

constexpr std::array<std::pair<const char*, std::pair<double, double>>, 6> kPapers{{{"A4", {210, 297}},
                                                                                    {"A3", {297, 420}},
                                                                                    {"A2", {420, 594}},
                                                                                    {"A1", {594, 841}},
                                                                                    {"A0", {841, 1189}},
                                                                                    {"letter", {215.9, 279.4}}}};

class Page {
 public:
  Page(double width_mm, double height_mm)
      : surface_(
            cairo_pdf_surface_create_for_stream(append, &bytes_, width_mm * kPointsPerMm, height_mm * kPointsPerMm),
            cairo_surface_destroy),
        cairo_(cairo_create(surface_.get()), cairo_destroy) {
    cairo_pdf_surface_set_metadata(surface_.get(), CAIRO_PDF_METADATA_CREATOR, "Foresight");
    cairo_scale(cairo_.get(), kPointsPerMm, kPointsPerMm);
    cairo_select_font_face(cairo_.get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo_.get(), 3.2);
    cairo_set_line_width(cairo_.get(), 0.15);
  }

  cairo_t* cairo() const { return cairo_.get(); }

  void text(double x, double y, const std::string& text, double turned = 0) const {
    cairo_save(cairo());
    cairo_move_to(cairo(), x, y);
    cairo_rotate(cairo(), turned);
    cairo_show_text(cairo(), text.c_str());
    cairo_restore(cairo());
  }

  /// From (x, y) on, 1 mm ticks, `length` mm; along y where `turned`.
  void ruler(double x, double y, double length, bool turned) const {
    cairo_save(cairo());
    cairo_translate(cairo(), x, y);
    if (turned) cairo_rotate(cairo(), M_PI / 2);
    const auto line = [this](double x0, double y0, double x1, double y1) {
      cairo_move_to(cairo(), x0, y0);
      cairo_line_to(cairo(), x1, y1);
      cairo_stroke(cairo());
    };
    line(0, 0, length, 0);
    for (int mm = 0; mm <= static_cast<int>(length); ++mm) {
      const double tick = mm % 10 == 0 ? 4 : mm % 5 == 0 ? 2.5 : 1.5;
      line(mm, 0, mm, turned ? tick : -tick);
    }
    text(length / 2 - 22, turned ? 8 : -5, (turned ? "y: " : "x: ") + readable(length, 0) + " mm, measure end to end");
    cairo_restore(cairo());
  }

  const std::string& finish() {
    cairo_show_page(cairo());
    cairo_surface_finish(surface_.get());
    if (cairo_surface_status(surface_.get()) != CAIRO_STATUS_SUCCESS)
      throw RuntimeFailure(
          "cairo cannot make the PDF: " + std::string(cairo_status_to_string(cairo_surface_status(surface_.get()))),
          "free some memory");
    return bytes_;
  }

 private:
  static cairo_status_t append(void* to, const unsigned char* data, unsigned length) {
    static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), length);
    return CAIRO_STATUS_SUCCESS;
  }

  std::string bytes_;
  std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface_;
  std::unique_ptr<cairo_t, void (*)(cairo_t*)> cairo_;
};

Board scaled(const Board& board, double scale) {
  Board other = board;
  other.size_m *= scale;
  other.marker_m *= scale;
  other.gap_m *= scale;
  return other;
}

std::string in_mm(double width, double height) {
  return readable(width, 0) + " x " + readable(height, 0) + " mm";
}

}  // namespace

Paper parse_paper(std::string_view text) {
  for (const auto& [name, size] : kPapers)
    if (text == name) return {name, size.first, size.second};
  const std::size_t x = text.find('x');
  if (x != std::string_view::npos) {
    std::string_view rest = text.substr(x + 1);
    if (rest.ends_with("_mm") || rest.ends_with("mm")) rest = rest.substr(0, rest.find_first_of("_m"));
    const auto w = parse_number(text.substr(0, x)), h = parse_number(rest);
    if (w && h && *w >= 50 && *h >= 50 && *w <= 5000 && *h <= 5000)
      return {std::string(text), std::min(*w, *h), std::max(*w, *h)};
  }
  throw InputError("--paper", in_quotes(text) + " is no paper",
                   "give A4, A3, A2, A1, A0, letter, or WxH in mm such as 600x400");
}

void write_board_pdf(const std::filesystem::path& file, const Board& board, const Paper& paper) {
  require_printable(board);
  const BoardExtent e = board_extent(board);
  const double w = e.width() * 1e3, h = e.height() * 1e3;
  const double across = 2 * kRimMm + kStripMm, along = 2 * kRimMm + kStripMm + 5;
  const auto scale_on = [&](double width, double height) {
    return std::min((width - across) / w, (height - along) / h);
  };
  const bool lying = scale_on(paper.height_mm, paper.width_mm) > scale_on(paper.width_mm, paper.height_mm);
  const double width = lying ? paper.height_mm : paper.width_mm, height = lying ? paper.width_mm : paper.height_mm;
  const double fit = scale_on(width, height);
  if (fit < 1) {
    const double size = std::floor(board.size_m * fit * 1e4) / 1e4;
    std::string cure = "take a larger --paper";
    if (size > 0) cure += ", or " + to_string(scaled(board, size / board.size_m));
    throw InputError("--board",
                     "needs " + in_mm(w, h) + ", " + paper.name + " leaves " + in_mm(width - across, height - along),
                     cure);
  }
  if (std::min(width - across, height - along) < kRulerMm)
    throw InputError("--paper", paper.name + " has no room for both rulers of " + readable(kRulerMm, 0) + " mm",
                     "take a larger one: without both, nobody knows how large the print became");
  Page page(width, height);
  const double x = kRimMm + kStripMm + (width - across - w) / 2, y = kRimMm + (height - along - h) / 2;
  cairo_save(page.cairo());
  cairo_translate(page.cairo(), x - e.left * 1e3, y - e.top * 1e3);
  draw_board(page.cairo(), board);
  cairo_restore(page.cairo());
  page.ruler(kRimMm + kStripMm, height - kRimMm - 5, kRulerMm, false);
  page.ruler(kRimMm + 5, kRimMm, kRulerMm, true);
  page.text(kRimMm + kStripMm, height - kRimMm,
            "--board " + to_string(board) + "   print at 100 %, not fitted to the page; glue it onto something flat");
  write_file_atomically(file, page.finish());
}

Board measured_board(const Board& board, double x_mm, double y_mm) {
  for (const double mm : {x_mm, y_mm})
    if (!(mm > 0.5 * kRulerMm && mm < 2 * kRulerMm))
      throw InputError("--measured", readable(mm, 2) + " mm is not the length of a ruler of 100 mm",
                       "measure both rulers end to end, in mm: --measured 100.2,99.9");
  const double sx = x_mm / kRulerMm, sy = y_mm / kRulerMm;
  if (std::abs(sx / sy - 1) > kMostAnisotropy)
    throw InputError(
        "--measured",
        "x is printed at " + readable(100 * sx, 2) + " %, y at " + readable(100 * sy, 2) +
            " %: stretched squares cannot calibrate",
        "print without 'fit to page', at the printer's best quality; turn the page, or use another printer");
  return scaled(board, (sx + sy) / 2);
}

}  // namespace foresight
