#include "file_window.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "rigproof/core/error.h"

namespace rigproof {
namespace {

// Small records are read so many bytes at a time.
constexpr std::size_t kWindow = 1U << 18U;

}  // namespace

FileWindow::FileWindow(const std::filesystem::path& file) : file_(file) {
  descriptor_ = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0) {
    const std::string reason = std::strerror(errno);
    if (descriptor_ >= 0) ::close(descriptor_);
    throw Error(file.string() + ": " + reason);
  }
  size_ = static_cast<std::uint64_t>(std::max<off_t>(status.st_size, 0));
}

FileWindow::~FileWindow() { ::close(descriptor_); }

bool FileWindow::has_grown_or_stayed() {
  struct stat opened {
  }, named{};
  if (::fstat(descriptor_, &opened) != 0 || ::stat(file_.c_str(), &named) != 0) return false;
  const auto size = static_cast<std::uint64_t>(std::max<off_t>(opened.st_size, 0));
  if (opened.st_dev != named.st_dev || opened.st_ino != named.st_ino || size < size_) return false;
  size_ = size;
  filled_ = 0;  // space that was reserved may have been written since
  return true;
}

std::string_view FileWindow::at(std::uint64_t position, std::size_t length) {
  if (position >= begin_ && position + length <= begin_ + filled_)
    return {buffer_.data() + (position - begin_), length};
  const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(std::max(length, kWindow), size_ - position));
  char* bytes = buffer_.reserve(wanted);
  begin_ = position;
  filled_ = 0;
  while (filled_ < wanted) {
    const ssize_t count =
        ::pread(descriptor_, bytes + filled_, wanted - filled_, static_cast<off_t>(position + filled_));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    filled_ += static_cast<std::size_t>(count);
  }
  if (filled_ < length) throw Error(file_.string() + ": cannot be read at byte " + std::to_string(position));
  return {bytes, length};
}

}  // namespace rigproof
