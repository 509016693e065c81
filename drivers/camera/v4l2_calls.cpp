#include "drivers/camera/v4l2_calls.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>

#include "common/text.hpp"

namespace foresight::v4l2 {
namespace {

class SystemCalls final : public Calls {
 public:
  std::vector<std::string> devices() override {
    std::vector<std::pair<long long, std::string>> found;
    std::error_code error;
    for (std::filesystem::directory_iterator i("/dev", error), end; !error && i != end; i.increment(error)) {
      const std::string name = i->path().filename().string();
      if (!name.starts_with("video")) continue;
      if (const auto number = parse_integer(std::string_view(name).substr(5))) found.emplace_back(*number, i->path());
    }
    std::sort(found.begin(), found.end());
    std::vector<std::string> out;
    for (auto& [number, path] : found) out.push_back(std::move(path));
    return out;
  }

  std::string serial(const std::string& device) override {
    std::error_code error;
    const auto real = std::filesystem::canonical(device, error);
    // The link leads to the USB interface; the serial number belongs to the device above it.
    std::ifstream file("/sys/class/video4linux/" + real.filename().string() + "/device/../serial");
    std::string out;
    std::getline(file, out);
    return out;
  }

  UniqueFd open(const std::string& device) override {
    return UniqueFd(::open(device.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
  }

  int ioctl(int fd, unsigned long request, void* argument) override {
    int result = 0;
    do result = ::ioctl(fd, request, argument);
    while (result == -1 && errno == EINTR);
    return result;
  }

  void* map(std::size_t bytes, int fd, std::int64_t offset) override {
    // Writable, too: some drivers refuse a mapping that is not.
    void* const address = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, offset);
    return address == MAP_FAILED ? nullptr : address;
  }

  void unmap(void* address, std::size_t bytes) override { ::munmap(address, bytes); }

  int wait(int fd, Duration timeout, bool& broken) override {
    pollfd entry{.fd = fd, .events = POLLIN, .revents = 0};
    const auto ms = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
    const int result = ::poll(&entry, 1, static_cast<int>(std::clamp<long long>(ms, 0, 60'000)));
    broken = result > 0 && (entry.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0;
    return result == -1 && errno == EINTR ? 0 : result;
  }
};

}  // namespace

Calls& system_calls() {
  static SystemCalls calls;
  return calls;
}

}  // namespace foresight::v4l2
