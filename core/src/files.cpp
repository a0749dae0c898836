#include "rigproof/core/files.h"

#include <fcntl.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <system_error>

#include "rigproof/core/error.h"
#include "rigproof/core/folders.h"
#include "rigproof/core/growing_file.h"
#include "rigproof/core/text.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

// Owns a file descriptor.
class Descriptor {
 public:
  explicit Descriptor(int descriptor) : descriptor_(descriptor) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return descriptor_; }
  bool valid() const { return descriptor_ >= 0; }
  int close() {
    const int result = descriptor_ >= 0 ? ::close(descriptor_) : 0;
    descriptor_ = -1;
    return result;
  }

 private:
  int descriptor_;
};

// A temporary file that is removed unless it was renamed.
class TemporaryFile {
 public:
  explicit TemporaryFile(fs::path path) : path_(std::move(path)) {}
  ~TemporaryFile() {
    if (!path_.empty()) ::unlink(path_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const fs::path& path() const { return path_; }
  void keep() { path_.clear(); }

 private:
  fs::path path_;
};

// Machines that share the folder have processes of the same number; in containers most have.
fs::path temporary_name(const fs::path& file) {
  static const std::uint32_t machine = std::random_device()();
  static std::atomic<unsigned> count{0};
  return file.parent_path() / ("." + file.filename().string() + "." + std::to_string(machine) + "." +
                               std::to_string(::getpid()) + "." + std::to_string(count.fetch_add(1)) + ".tmp");
}

void create_parent(const fs::path& file) {
  if (file.has_parent_path()) create_folder(file.parent_path());
}

void write_all(int descriptor, const char* data, std::size_t size, const fs::path& file) {
  while (size > 0) {
    const ssize_t written = ::write(descriptor, data, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw_system_error(file, "write", errno);
    data += written;
    size -= static_cast<std::size_t>(written);
  }
}

// The rename itself must reach the disk, too. Some file systems cannot sync a folder: they answer EINVAL.
void sync_folder_of(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const Descriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!descriptor.valid() || (::fsync(descriptor.get()) != 0 && errno != EINVAL))
    throw_system_error(file, "write its folder", errno);
}

void sync_file(const fs::path& file) {
  const Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (!descriptor.valid() || ::fsync(descriptor.get()) != 0) throw_system_error(file, "write", errno);
}

// A pipe that nobody reads must not hang the writer, and a disk is no place for a file.
void write_through(const fs::path& file, const char* data, std::size_t size) {
  const Descriptor descriptor(::open(file.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK));
  if (!descriptor.valid() && errno == ENXIO) throw Error(file.string() + ": cannot write: nobody reads this pipe");
  if (!descriptor.valid() || ::fcntl(descriptor.get(), F_SETFL, 0) != 0) throw_system_error(file, "write", errno);
  write_all(descriptor.get(), data, size, file);
}

void write_bytes(const fs::path& file, const char* data, std::size_t size, bool sync) {
  if (takes_bytes_itself(file)) return write_through(file, data, size);
  create_parent(file);
  const fs::path temporary = temporary_name(file);
  Descriptor descriptor(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!descriptor.valid()) throw_system_error(file, "write", errno);
  TemporaryFile guard(temporary);
  write_all(descriptor.get(), data, size, file);
  if (sync && ::fsync(descriptor.get()) != 0) throw_system_error(file, "write", errno);
  if (descriptor.close() != 0) throw_system_error(file, "write", errno);
  if (::rename(temporary.c_str(), file.c_str()) != 0) throw_system_error(file, "write", errno);
  guard.keep();
  if (sync) sync_folder_of(file);
}

// Opens a regular file for reading and tells its size. O_NONBLOCK: a pipe must not hang the reader.
int open_regular(const fs::path& file, std::uintmax_t max_bytes, std::size_t* size) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) throw_system_error(file, "read", errno);
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
    ::close(descriptor);
    throw Error(file.string() + ": not a regular file");
  }
  *size = static_cast<std::size_t>(status.st_size);
  if (*size > max_bytes) {
    ::close(descriptor);
    throw Error(file.string() + ": " + std::to_string(*size) + " bytes, allowed are at most " +
                std::to_string(max_bytes));
  }
  return descriptor;
}

// Reads up to `size` bytes; fewer only at the end of the file.
std::size_t read_some(int descriptor, char* data, std::size_t size, const fs::path& file) {
  std::size_t done = 0;
  while (done < size) {
    const ssize_t count = ::read(descriptor, data + done, size - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw_system_error(file, "read", errno);
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  return done;
}

template <typename Bytes>
Bytes read_bytes(const fs::path& file, std::uintmax_t max_bytes) {
  std::size_t size = 0;
  const Descriptor descriptor(open_regular(file, max_bytes, &size));
  Bytes bytes;
  bytes.resize(size);
  bytes.resize(read_some(descriptor.get(), reinterpret_cast<char*>(bytes.data()), size, file));
  return bytes;
}

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new()) {
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1) throw Error("SHA-256: no context");
  }
  void update(const void* data, std::size_t size) {
    if (EVP_DigestUpdate(context_.get(), data, size) != 1) throw Error("SHA-256: update failed");
  }
  std::string hex() {
    std::array<unsigned char, 32> digest{};
    if (EVP_DigestFinal_ex(context_.get(), digest.data(), nullptr) != 1) throw Error("SHA-256: final failed");
    static const char* const kHex = "0123456789abcdef";
    std::string text;
    for (const unsigned char byte : digest) {
      text += kHex[byte >> 4U];
      text += kHex[byte & 15U];
    }
    return text;
  }

 private:
  struct Free {
    void operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }
  };
  std::unique_ptr<EVP_MD_CTX, Free> context_;
};

bool is_within(const fs::path& folder, const fs::path& path) {
  auto a = folder.begin();
  auto b = path.begin();
  for (; a != folder.end(); ++a, ++b) {
    if (a->empty()) break;  // a trailing slash
    if (b == path.end() || *a != *b) return false;
  }
  return true;
}

}  // namespace

// A link in a folder of somebody else may lead anywhere, and a device that became a file is missed by every other
// program.
bool takes_bytes_itself(const fs::path& file) {
  std::error_code ignored;
  const fs::file_status status = fs::status(file, ignored);
  if (fs::is_fifo(status) || fs::is_character_file(status)) return true;
  if (fs::is_symlink(fs::symlink_status(file, ignored)))
    throw Error(file.string() + ": cannot write: it is a link to " + fs::read_symlink(file, ignored).string() +
                ", and links are not followed; name the file itself, or remove the link");
  if (fs::is_block_file(status) || fs::is_socket(status))
    throw Error(file.string() + ": cannot write: it is no regular file");
  return false;
}

void write_file_atomically(const fs::path& file, std::string_view bytes) {
  write_bytes(file, bytes.data(), bytes.size(), true);
}

void write_file_atomically(const fs::path& file, const std::vector<std::uint8_t>& bytes) {
  write_bytes(file, reinterpret_cast<const char*>(bytes.data()), bytes.size(), true);
}

void write_file_atomically_unsynced(const fs::path& file, std::string_view bytes) {
  write_bytes(file, bytes.data(), bytes.size(), false);
}

GrowingFile::GrowingFile(fs::path file) : file_(std::move(file)) {
  if (takes_bytes_itself(file_)) throw Error(file_.string() + ": cannot write: it is no regular file");
  create_parent(file_);
  temporary_ = temporary_name(file_);
  descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw_system_error(file_, "write", errno);
}

GrowingFile::~GrowingFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  ::unlink(temporary_.c_str());
}

void GrowingFile::write_out() {
  write_all(descriptor_, unwritten_.data(), unwritten_.size(), file_);
  unwritten_.clear();
}

void GrowingFile::append(std::string_view bytes) {
  constexpr std::size_t kPiece = 1U << 20U;
  unwritten_ += bytes;
  if (unwritten_.size() >= kPiece) write_out();
}

void GrowingFile::finish() {
  write_out();
  if (::fsync(descriptor_) != 0 || ::rename(temporary_.c_str(), file_.c_str()) != 0)
    throw_system_error(file_, "write", errno);
  ::close(descriptor_);
  descriptor_ = -1;
  sync_folder_of(file_);
}

void sync_files(const std::vector<fs::path>& files) {
  std::map<fs::path, fs::path> one_of_folder;
  for (const fs::path& file : files) {
    if (std::error_code ignored; !fs::is_directory(file, ignored)) sync_file(file);
    one_of_folder[file.parent_path()] = file;
  }
  for (const auto& entry : one_of_folder) sync_folder_of(entry.second);
}

std::string read_text_file(const fs::path& file, std::uintmax_t max_bytes) {
  return read_bytes<std::string>(file, max_bytes);
}

std::vector<std::uint8_t> read_binary_file(const fs::path& file, std::uintmax_t max_bytes) {
  return read_bytes<std::vector<std::uint8_t>>(file, max_bytes);
}

void require_disk_space(const fs::path& folder, double needed_bytes, double share) {
  std::error_code error;
  const auto free_bytes = static_cast<double>(fs::space(folder, error).available);
  if (error || free_bytes >= share * needed_bytes) return;
  throw Error(folder.string() + ": the disk is nearly full: about " + megabytes(needed_bytes) + " are needed, " +
              megabytes(free_bytes) + " are free");
}

std::string sha256_hex(std::string_view bytes) {
  Sha256 hash;
  hash.update(bytes.data(), bytes.size());
  return hash.hex();
}

std::string sha256_hex_of_file(const fs::path& file) {
  std::size_t size = 0;
  const Descriptor descriptor(open_regular(file, std::numeric_limits<std::uintmax_t>::max(), &size));
  std::vector<char> buffer(std::size_t{1} << 18U);
  Sha256 hash;
  while (const std::size_t count = read_some(descriptor.get(), buffer.data(), buffer.size(), file))
    hash.update(buffer.data(), count);
  return hash.hex();
}

fs::path path_inside(const fs::path& folder, const std::string& relative) {
  const auto refuse = [&](const std::string& why) -> Error {
    return Error(folder.string() + ": \"" + for_message(relative) + "\" " + why +
                 "; a path inside of the folder is allowed");
  };
  const fs::path path(relative);
  if (relative.empty() || relative.find('\0') != std::string::npos) throw refuse("is not a path");
  if (path.is_absolute()) throw refuse("is absolute");
  if (*path.lexically_normal().begin() == "..") throw refuse("leaves the folder");
  std::error_code error;
  const fs::path real_folder = fs::weakly_canonical(folder, error);
  if (error) throw Error(folder.string() + ": " + error.message());
  const fs::path real = fs::weakly_canonical(folder / path, error);
  if (error) throw refuse("cannot be resolved (" + error.message() + ")");
  if (!is_within(real_folder, real)) throw refuse("leaves the folder through a link");
  return folder / path;
}

}  // namespace rigproof
