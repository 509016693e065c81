#include "calibration/photometric/exposure_series.hpp"

#include <algorithm>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "common/error.hpp"
#include "common/text.hpp"
#include "pictures/picture_file.hpp"
#include "scene/files.hpp"
#include "scene/text_table.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

constexpr int kStaticBlock = 5;    // px
constexpr int kFlatColumns = 32;   // blocks of a flat field
constexpr double kLongest = 3600;  // seconds

std::optional<double> seconds(const std::string& text) {
  const auto slash = text.find('/');
  const auto above = parse_number(text.substr(0, slash));
  const auto below = slash == std::string::npos ? std::optional(1.0) : parse_number(text.substr(slash + 1));
  if (!above || !below || !(*above > 0) || !(*below > 0) || !(*above / *below <= kLongest)) return std::nullopt;
  return *above / *below;
}

// TIFF structures inside a JPEG's APP1 segment.
class Exif {
 public:
  explicit Exif(std::string_view bytes) : bytes_(bytes), little_(bytes.starts_with("II")) {}

  std::optional<double> exposure() const {
    const auto sub = entry(read(4, 4).value_or(0), 0x8769);
    if (!sub) return std::nullopt;
    const auto tag = entry(read(*sub + 8, 4).value_or(0), 0x829a);
    if (!tag) return std::nullopt;
    const auto at = read(*tag + 8, 4);
    const auto above = at ? read(*at, 4) : at, below = at ? read(*at + 4, 4) : at;
    if (!above || !below || *below == 0 || *above == 0) return std::nullopt;
    return static_cast<double>(*above) / static_cast<double>(*below);
  }

 private:
  std::optional<std::uint32_t> read(std::uint32_t at, std::uint32_t size) const {
    if (at > bytes_.size() || bytes_.size() - at < size) return std::nullopt;
    std::uint32_t value = 0;
    for (std::uint32_t i = 0; i < size; ++i) {
      const auto byte = static_cast<unsigned char>(bytes_[at + (little_ ? size - 1 - i : i)]);
      value = value << 8 | byte;
    }
    return value;
  }

  // Offset of the 12 bytes of `tag` in the directory at `directory`.
  std::optional<std::uint32_t> entry(std::uint32_t directory, std::uint32_t tag) const {
    const auto count = read(directory, 2);
    if (!directory || !count) return std::nullopt;
    for (std::uint32_t i = 0; i < *count; ++i)
      if (read(directory + 2 + 12 * i, 2) == tag) return directory + 2 + 12 * i;
    return std::nullopt;
  }

  std::string_view bytes_;
  bool little_;
};

ExposedImage read_one(const fs::path& file, const std::map<std::string, double>& exposures) {
  ExposedImage image{file.filename().string(), 0, read_picture(file, PictureColours::as_stored)};
  if (image.pixels.depth() != CV_8U)
    throw InputError(file.string(), "is no 8-bit image", "give PNG or JPEG images of the camera itself");
  if (image.pixels.channels() == 4) cv::cvtColor(image.pixels, image.pixels, cv::COLOR_BGRA2BGR);
  if (exposures.empty()) {
    const auto exposure = exif_exposure(file);
    if (!exposure)
      throw InputError(file.string(), "has no exposure time in its EXIF data",
                       "give --exposures FILE with a row 'NAME SECONDS' per image");
    image.exposure_s = *exposure;
    return image;
  }
  const auto named = exposures.find(image.name);
  if (named == exposures.end()) {
    std::vector<std::string> names;
    for (const auto& [name, exposure] : exposures) names.push_back(name);
    throw InputError("--exposures", "has no row for the image " + in_quotes(image.name),
                     "add it; " + did_you_mean(image.name, names));
  }
  image.exposure_s = named->second;
  return image;
}

double mean_level(const cv::Mat& pixels, const cv::Rect& block, int channel) {
  return cv::mean(pixels(block))[channel];
}

// Sets the level of a block; false where it is too dark or saturated.
bool take(const ExposedImage& image, const cv::Rect& block, int channel, LevelSample& sample, SeriesSamples& out) {
  const cv::Mat pixels = image.pixels(block);
  for (int y = 0; y < pixels.rows; ++y)
    for (int x = 0; x < pixels.cols; ++x)
      if (pixels.ptr(y)[x * pixels.channels() + channel] > kBrightest) {
        ++out.saturated;
        return false;
      }
  sample.level = mean_level(image.pixels, block, channel);
  if (sample.level >= kDarkest) return true;
  ++out.dark;
  return false;
}

// Grid places, the smoothest of each cell.
std::vector<cv::Point> smooth_places(const cv::Mat& picture, int most) {
  cv::Mat grey = picture, mean, squares, wide;
  if (picture.channels() == 3) cv::cvtColor(picture, grey, cv::COLOR_BGR2GRAY);
  grey.convertTo(wide, CV_32F);
  const cv::Size block(kStaticBlock, kStaticBlock);
  cv::blur(wide, mean, block);
  cv::blur(wide.mul(wide), squares, block);
  const cv::Mat variance = squares - mean.mul(mean);
  const int columns = std::max(1, static_cast<int>(std::sqrt(most * double(grey.cols) / grey.rows)));
  const int rows = std::max(1, most / columns);
  std::vector<cv::Point> places;
  constexpr int kHalf = kStaticBlock / 2;
  const cv::Rect inside(kHalf, kHalf, grey.cols - 2 * kHalf, grey.rows - 2 * kHalf);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const cv::Rect cell =
          cv::Rect(grey.cols * c / columns, grey.rows * r / rows, grey.cols / columns, grey.rows / rows) & inside;
      if (cell.empty()) continue;
      cv::Point place;
      cv::minMaxLoc(variance(cell), nullptr, nullptr, &place);
      places.push_back(place + cell.tl());
    }
  return places;
}

}  // namespace

std::map<std::string, double> read_exposures(const fs::path& file) {
  std::map<std::string, double> out;
  for_each_row(file, "name seconds", [&](const TextRow& row) {
    const auto exposure = seconds(std::string(row.fields[1]));
    if (!exposure)
      throw InputError(row.where(), in_quotes(row.fields[1]) + " is no exposure time",
                       "write seconds, such as 0.008 or 1/125");
    if (!out.emplace(row.fields[0], *exposure).second)
      throw InputError(row.where(), "the image " + in_quotes(row.fields[0]) + " is named twice", "remove one row");
  });
  return out;
}

std::optional<double> exif_exposure(const fs::path& file) {
  const std::string bytes = read_file(file);
  if (!bytes.starts_with("\xff\xd8")) return std::nullopt;
  for (std::size_t at = 2; at + 4 <= bytes.size() && bytes[at] == '\xff';) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
    const std::size_t length = static_cast<std::size_t>(byte(at + 2)) << 8 | byte(at + 3);
    const std::string_view segment = std::string_view(bytes).substr(at + 4, length - std::min<std::size_t>(length, 2));
    if (byte(at + 1) == 0xe1 && segment.starts_with(std::string_view("Exif\0\0", 6)))
      return Exif(segment.substr(6)).exposure();
    if (byte(at + 1) == 0xda) break;
    at += 2 + length;
  }
  return std::nullopt;
}

std::vector<ExposedImage> read_series(const fs::path& folder, const std::map<std::string, double>& exposures) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(canonical_folder(folder)))
    if (entry.is_regular_file() && names_picture(entry.path())) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty()) throw InputError(folder.string(), "holds no images", "name a folder of PNG or JPEG images");
  std::vector<ExposedImage> series;
  for (const fs::path& file : files) {
    series.push_back(read_one(file, exposures));
    if (series.back().pixels.size() != series.front().pixels.size() ||
        series.back().pixels.type() != series.front().pixels.type())
      throw InputError(file.string(), "differs in size or channels from " + series.front().name,
                       "keep the images of one camera in a folder");
  }
  return series;
}

void judge_series(const std::vector<ExposedImage>& series, Verdict& verdict) {
  std::string names;
  for (std::size_t i = 0; i < series.size(); ++i)
    for (std::size_t j = i + 1; j < series.size(); ++j) {
      const ExposedImage &a = series[i], &b = series[j];
      if (a.exposure_s == b.exposure_s || cv::norm(a.pixels, b.pixels, cv::NORM_INF) > 0) continue;
      names += (names.empty() ? "" : ", ") + a.name + " and " + b.name;
      break;
    }
  if (!names.empty())
    verdict.object("pictures of different exposure times are the same: " + names,
                   "give each picture its own file, and switch automatic exposure off");
}

void add_static(const std::vector<ExposedImage>& series, int most, SeriesSamples& out) {
  const int channels = series.front().pixels.channels();
  // Places are chosen in the image of middle brightness, where most of them can be judged.
  const auto middle = [&] {
    std::vector<std::pair<double, const ExposedImage*>> by_brightness;
    for (const ExposedImage& image : series)
      by_brightness.emplace_back(std::abs(cv::mean(image.pixels)[0] - 110), &image);
    return std::min_element(by_brightness.begin(), by_brightness.end())->second;
  }();
  for (const cv::Point& place : smooth_places(middle->pixels, most / channels)) {
    const cv::Rect block(place.x - kStaticBlock / 2, place.y - kStaticBlock / 2, kStaticBlock, kStaticBlock);
    for (int c = 0; c < channels; ++c, ++out.radiances)
      for (std::size_t i = 0; i < series.size(); ++i) {
        LevelSample sample{out.images + static_cast<int>(i), series[i].exposure_s, out.radiances, -1, 0};
        if (take(series[i], block, c, sample, out)) out.samples.push_back(sample);
      }
  }
  out.images += static_cast<int>(series.size());
}

void add_flat(const std::vector<ExposedImage>& series, const Eigen::Vector2d& centre, SeriesSamples& out) {
  const cv::Mat& first = series.front().pixels;
  const int size = std::max(1, first.cols / kFlatColumns);
  const double half_diagonal_2 = (first.cols * double(first.cols) + first.rows * double(first.rows)) / 4;
  for (std::size_t i = 0; i < series.size(); ++i)
    for (int y = 0; y + size <= first.rows; y += size)
      for (int x = 0; x + size <= first.cols; x += size) {
        const Eigen::Vector2d at(x + (size - 1) / 2.0, y + (size - 1) / 2.0);
        for (int c = 0; c < first.channels(); ++c) {
          LevelSample sample{out.images + static_cast<int>(i), series[i].exposure_s, out.radiances + c,
                             (at - centre).squaredNorm() / half_diagonal_2, 0};
          if (take(series[i], {x, y, size, size}, c, sample, out)) out.samples.push_back(sample);
        }
      }
  for (int c = 0; c < first.channels(); ++c) out.flat_radiances.push_back(out.radiances++);
  out.images += static_cast<int>(series.size());
}

}  // namespace foresight
