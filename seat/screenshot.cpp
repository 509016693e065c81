#include "seat/screenshot.hpp"

#include <fmt/core.h>

#include <exception>

#include "common/atomic_file.hpp"
#include "pictures/encode.hpp"

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
    const std::vector<std::uint8_t> bytes = encode_png(picture, 3);
    write_file_atomically(out.file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  } catch (const std::exception& error) {
    out.trouble = error.what();
  }
  return out;
}

}  // namespace foresight
