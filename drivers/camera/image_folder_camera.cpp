#include "drivers/camera/image_folder_camera.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/text.hpp"
#include "pictures/picture_file.hpp"

namespace foresight {
namespace {

/// The number at the end of "left_0012", and what stands in front of it.
std::optional<std::pair<std::string, long long>> split_number(const std::string& stem) {
  std::size_t at = stem.size();
  while (at > 0 && stem[at - 1] >= '0' && stem[at - 1] <= '9') --at;
  const auto number = parse_integer(std::string_view(stem).substr(at));
  if (!number) return std::nullopt;
  return std::pair(stem.substr(0, at), *number);
}

bool is_image(const std::filesystem::path& file) {
  const auto extension = file.extension();
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".ppm";
}

}  // namespace

ImageFolderCamera::ImageFolderCamera(std::string name, const std::filesystem::path& folder, const Options& options,
                                     Clock& clock)
    : name_(std::move(name)), folder_(folder), options_(options), clock_(clock) {
  const std::string where = "camera '" + name_ + "'";
  if (!(options.rate > 0) || !std::isfinite(options.rate)) {
    throw InputError(where, "rate = " + std::to_string(options.rate), "give more than 0 frames per second");
  }
  std::error_code error;
  std::vector<std::pair<long long, std::filesystem::path>> found;
  for (std::filesystem::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
    const auto parts = split_number(i->path().stem().string());
    if (parts && is_image(i->path()) && std::filesystem::is_regular_file(i->path(), error) &&
        (options.prefix.empty() || parts->first == options.prefix))
      found.emplace_back(parts->second, i->path());
  }
  if (error) throw InputError(where, "cannot read the folder " + folder.string(), "give a folder of images");
  if (found.empty()) {
    throw InputError(where, "no numbered images '" + options.prefix + "<number>' in " + folder.string(),
                     "correct folder or prefix");
  }
  std::sort(found.begin(), found.end());
  for (std::size_t i = 1; i < found.size(); ++i) {
    if (found[i].first != found[i - 1].first) continue;
    throw InputError(where, found[i - 1].second.string() + " and " + found[i].second.string() + " have one number",
                     "give a prefix");
  }
  for (auto& [number, file] : found) files_.push_back(std::move(file));
}

void ImageFolderCamera::start() {
  const cv::Mat first = read_picture(files_.front(), PictureColours::colour);
  settings_ = {.width = first.cols,
               .height = first.rows,
               .rate = options_.rate,
               .format = PixelFormat::bgr,
               .controls = {},
               .readout = Duration{0}};
  start_ = clock_.now();
  next_ = 0;
  counters_ = {};
  started_ = true;
}

void ImageFolderCamera::stop() noexcept {
  started_ = false;
}

void ImageFolderCamera::set_control(const std::string& control, std::int64_t) {
  throw InputError("camera '" + name_ + "'", "there is no control " + in_quotes(control), "leave it out");
}

CameraStatus ImageFolderCamera::wait_frame(Duration timeout, CameraFrame& out) noexcept {
  const RobotTime now = clock_.now();
  const bool at_end = !options_.repeat && next_ >= files_.size();
  if (!started_ || at_end) {
    clock_.sleep_until(now + timeout);
    return CameraStatus::lost;
  }
  const RobotTime due = start_ + seconds(static_cast<double>(next_ + 1) / options_.rate);
  if (due > now + timeout) {
    clock_.sleep_until(now + timeout);
    return CameraStatus::timeout;
  }
  clock_.sleep_until(due);
  const std::uint64_t index = next_++;
  // A consumer that was away is not flooded with what it missed; as with a camera, these frames are gone.
  const auto missed = static_cast<std::uint64_t>(std::max(0.0, to_seconds(clock_.now() - due) * options_.rate));
  next_ += missed;
  counters_.gaps += missed;
  cv::Mat image;
  try {
    image = read_picture(files_[index % files_.size()], PictureColours::colour);
  } catch (const std::exception&) {
    image.release();
  }
  if (image.cols != settings_.width || image.rows != settings_.height) {
    ++counters_.corrupt;
    return CameraStatus::corrupt;
  }
  ++counters_.frames;
  out = CameraFrame{.format = PixelFormat::bgr,
                    .width = image.cols,
                    .height = image.rows,
                    .stride = image.step[0],
                    .bytes = {image.data, image.step[0] * static_cast<std::size_t>(image.rows)},
                    .pixels = image,
                    .dmabuf = -1,
                    .sequence = index,
                    .time = due,
                    .uncertainty = Duration{0}};
  return CameraStatus::ok;
}

}  // namespace foresight
