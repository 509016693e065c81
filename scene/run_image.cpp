#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "common/error.hpp"
#include "pictures/decode.hpp"
#include "pictures/image_structure.hpp"
#include "scene/files.hpp"
#include "scene/run_folder.hpp"

namespace foresight {
namespace {

std::string size_text(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

void require_usable(const ImageForm& form, const Lens& lens, const std::string& file) {
  if (form.bits != 8)
    throw InputError(file, "the image has " + std::to_string(form.bits) + " bits per sample",
                     "convert it to 8-bit grey or 8-bit colour");
  if (form.has_alpha)
    throw InputError(file, "the image has transparency (alpha)", "convert it to 8-bit grey or colour without alpha");
  if (form.channels != 1 && form.channels != 3)
    throw InputError(file, "the image has " + std::to_string(form.channels) + " channels",
                     "convert it to 8-bit grey or 8-bit colour");
  if (form.width != lens.width() || form.height != lens.height())
    throw InputError(file,
                     "the image is " + size_text(form.width, form.height) + ", its camera file says " +
                         size_text(lens.width(), lens.height()),
                     "correct image_width and image_height, or the image");
}

// Finds the first bad image. Indices are handed out in order, and one that is handed out is
// always finished: when a worker fails, all earlier images have been or are being read.
class ImageCheck {
 public:
  explicit ImageCheck(const RunFolder& run) {
    for (const RunFrame& frame : run.frames()) {
      jobs_.push_back({&frame.left, &run.lens_left()});
      if (frame.right) jobs_.push_back({&*frame.right, &*run.lens_right()});
    }
    first_bad_ = jobs_.size();
  }

  void run(const std::function<void(std::size_t, std::size_t)>& progress) {
    {
      std::vector<std::jthread> workers;  // joined before the error is read, also when progress throws
      const std::size_t cores = std::max(1u, std::thread::hardware_concurrency());
      running_ = std::min(cores, jobs_.size());
      for (std::size_t i = running_; i-- > 0;) workers.emplace_back([this](std::stop_token stop) { work(stop); });
      std::unique_lock lock(mutex_);
      for (std::size_t told = 0; running_ > 0 || told < done_;) {
        changed_.wait(lock, [&] { return running_ == 0 || told < done_; });
        told = done_;
        if (!progress) continue;
        lock.unlock();
        progress(told, jobs_.size());
        lock.lock();
      }
    }
    if (error_) std::rethrow_exception(error_);
  }

 private:
  struct Job {
    const RunImage* image;
    const Lens* lens;
  };

  void work(const std::stop_token& stop) {
    for (std::size_t i = 0; !stop.stop_requested() && (i = next_++) < first_bad_;) {
      std::exception_ptr error;
      try {
        read_run_image(*jobs_[i].image, *jobs_[i].lens);
      } catch (...) {
        error = std::current_exception();
      }
      std::lock_guard lock(mutex_);
      ++done_;
      if (error && i < first_bad_) {
        first_bad_ = i;
        error_ = error;
      }
      changed_.notify_one();
    }
    std::lock_guard lock(mutex_);
    --running_;
    changed_.notify_one();
  }

  std::vector<Job> jobs_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<std::size_t> first_bad_ = 0;

  std::mutex mutex_;  // for what follows
  std::condition_variable changed_;
  std::size_t done_ = 0, running_ = 0;
  std::exception_ptr error_;
};

}  // namespace

cv::Mat read_run_image(const RunImage& image, const Lens& lens) {
  const std::string file = image.file.string();
  const std::string bytes = read_file(image.file);
  const ImageForm form = read_image_form(bytes, image.file);
  require_usable(form, lens, file);
  if (bytes.size() > 0x40000000u) throw InputError(file, "the image file exceeds 1 GiB", "compress it again");
  const cv::Mat pixels = decode_picture(bytes, PictureColours::as_stored).pixels;
  if (pixels.empty())
    throw InputError(file, "cannot be decoded (its compressed data are damaged)", "copy or record it again");
  if (pixels.type() != CV_8UC(form.channels) || pixels.cols != form.width || pixels.rows != form.height)
    throw InputError(file, "does not decode to what its header says", "convert it to 8-bit PNG");
  return pixels;
}

void check_run_images(const RunFolder& run, const std::function<void(std::size_t, std::size_t)>& progress) {
  ImageCheck(run).run(progress);
}

}  // namespace foresight
