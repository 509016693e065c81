// What our HTML pages share. They are self-contained: no network, light and dark mode.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace foresight {

/// The style sheet (page.css): colours, cards, tiles, tables, and the classes of SvgPlot.
std::string_view page_style();

/// `bytes` as a data URI, for an image inside the page; `mime` such as "image/png".
std::string data_uri(const std::string& mime, std::span<const unsigned char> bytes);

}  // namespace foresight
