#include "seat/screenshot.hpp"

#include <fmt/core.h>

#include <exception>

#include "pictures/picture_file.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

fs::path first_free(const fs::path& folder) {
  fs::path out;
  std::error_code unreadable;  // writing tells that, with the reason
  for (int number = 1; out.empty() || fs::exists(out, unreadable); ++number)
    out = folder / fmt::format("foresight-{:03}.png", number);
  return out;
}

}  // namespace

Screenshot save_screenshot(const fs::path& folder, const cv::Mat& picture) noexcept {
  Screenshot out;
  try {
    out.file = first_free(folder);
    write_png(out.file, picture);
  } catch (const std::exception& error) {
    out.trouble = error.what();
  }
  return out;
}

}  // namespace foresight
