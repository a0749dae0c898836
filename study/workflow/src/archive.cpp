#include "rigproof/study/workflow/archive.h"

#include <zstd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "rigproof/core/error.h"
#include "rigproof/core/files.h"
#include "rigproof/core/folders.h"
#include "rigproof/core/text.h"
#include "rigproof/study/workflow/folder_in_making.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBlock = 512;                              // of tar
constexpr std::uintmax_t kTooLarge = std::uintmax_t{8} << 30U;   // eleven octal digits
constexpr std::size_t kLongestName = 100, kLongestFolder = 155;  // of a POSIX ustar header

struct Member {
  std::string name;  // relative
  std::uintmax_t size_bytes = 0;
};

// POSIX ustar: the folders of a long path go into a field of their own. None if no slash divides it so.
std::optional<std::size_t> name_start(const std::string& path) {
  if (path.size() <= kLongestName) return 0;
  const std::size_t slash = path.find('/', path.size() - kLongestName - 1);
  if (slash > kLongestFolder) return std::nullopt;  // npos as well
  return slash + 1;
}

std::string header_of(const Member& member) {
  std::string header(kBlock, '\0');
  const auto put = [&](std::size_t at, const std::string& text) { header.replace(at, text.size(), text); };
  const std::size_t start = *name_start(member.name);
  std::array<char, 16> size{};
  std::snprintf(size.data(), size.size(), "%011llo", static_cast<unsigned long long>(member.size_bytes));
  put(0, member.name.substr(start));
  put(100, "0000644");
  put(108, "0000000");
  put(116, "0000000");
  put(124, size.data());
  put(136, "00000000000");
  put(148, "        ");  // the checksum counts its own field as spaces
  put(156, "0");
  put(257, "ustar");
  put(263, "00");
  if (start > 0) put(345, member.name.substr(0, start - 1));
  const unsigned sum = std::accumulate(header.begin(), header.end(), 0U,
                                       [](unsigned total, char c) { return total + static_cast<unsigned char>(c); });
  std::snprintf(size.data(), size.size(), "%06o", sum);
  put(148, std::string(size.data()) + '\0' + ' ');
  return header;
}

class Shard {
 public:
  explicit Shard(const fs::path& file) : file_(file), out_(file, std::ios::binary) { check(out_.good()); }

  void add(const fs::path& folder, const Member& member, std::string_view bytes) {
    if (bytes.size() != member.size_bytes) throw Error((folder / member.name).string() + ": changed while it was read");
    write(header_of(member));
    write(bytes);
    write(std::string((kBlock - bytes.size() % kBlock) % kBlock, '\0'));
  }

  void finish() {
    write(std::string(2 * kBlock, '\0'));
    compress({}, ZSTD_e_end);
    out_.close();
    check(!out_.fail());
  }

 private:
  void check(bool good) const {
    if (!good) throw Error(file_.string() + ": cannot be written: " + std::strerror(errno));
  }

  void write(std::string_view bytes) { compress(bytes, ZSTD_e_continue); }

  void compress(std::string_view bytes, ZSTD_EndDirective what) {
    ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
    std::size_t left = 0;
    do {
      ZSTD_outBuffer out{buffer_.data(), buffer_.size(), 0};
      left = ZSTD_compressStream2(stream_.get(), &out, &in, what);
      if (ZSTD_isError(left) != 0) throw Error(file_.string() + ": " + ZSTD_getErrorName(left));
      out_.write(buffer_.data(), static_cast<std::streamsize>(out.pos));
      check(out_.good());
    } while (what == ZSTD_e_end ? left > 0 : in.pos < in.size);
  }

  fs::path file_;
  std::ofstream out_;
  std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> stream_{ZSTD_createCCtx(), ZSTD_freeCCtx};
  std::vector<char> buffer_ = std::vector<char>(ZSTD_CStreamOutSize());
};

bool is_truth(const Member& member) { return member.name.rfind("truth/", 0) == 0; }

// Data first, then truth, each sorted by path.
std::vector<Member> members_of(const fs::path& folder) {
  std::vector<Member> members;
  std::vector<std::string> problems;
  for (const fs::directory_entry& entry : folder_tree(folder)) {
    const std::string name = entry.path().lexically_relative(folder).generic_string();
    if (entry.is_directory() && !entry.is_symlink()) continue;
    if (entry.is_symlink() || !entry.is_regular_file())
      problems.push_back(entry.path().string() + ": is no regular file; an archive holds nothing else");
    else if (!name_start(name))
      problems.push_back(entry.path().string() + ": its path is too long for a tar archive");
    else if (entry.file_size() >= kTooLarge)
      problems.push_back(entry.path().string() + ": is too large for a tar archive; at most 8 GiB");
    else
      members.push_back({name, entry.file_size()});
  }
  std::sort(problems.begin(), problems.end());
  if (!problems.empty()) throw Error(joined(problems, "\n"));
  std::sort(members.begin(), members.end(), [](const Member& a, const Member& b) {
    return std::make_pair(is_truth(a), a.name) < std::make_pair(is_truth(b), b.name);
  });
  return members;
}

// Index of the member behind the last of the shard that begins with `first`.
std::size_t shard_end(const std::vector<Member>& members, std::size_t first, std::uint64_t most_bytes) {
  std::uintmax_t bytes = members[first].size_bytes;
  std::size_t end = first + 1;
  for (; end < members.size() && is_truth(members[end]) == is_truth(members[first]); ++end) {
    bytes += members[end].size_bytes;
    if (bytes > most_bytes) break;
  }
  return end;
}

std::string shard_name(bool truth, std::size_t number) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%s-%05zu.tar.zst", truth ? "truth" : "data", number);
  return text.data();
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of("\",\n\r") == std::string::npos) return text;
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return cell + "\"";
}

}  // namespace

ArchiveReport write_archive(const fs::path& from, const fs::path& to, const ArchiveOptions& options) {
  const std::vector<Member> members = members_of(from);
  FolderInMaking making(to);
  std::string index = "shard,file,size_bytes,sha256\n", sums;
  std::array<std::size_t, 2> numbers{};
  std::vector<fs::path> written;
  for (std::size_t next = 0; next < members.size();) {
    const bool truth = is_truth(members[next]);
    const std::string name = shard_name(truth, numbers[truth ? 1 : 0]++);
    Shard shard(written.emplace_back(making.path() / name));
    for (const std::size_t end = shard_end(members, next, options.shard_bytes); next < end; ++next) {
      if (options.progress && !options.progress(next, members.size())) throw Error("interrupted", ExitCode::kTryAgain);
      const std::vector<std::uint8_t> read = read_binary_file(from / members[next].name, kTooLarge);
      const std::string_view bytes(reinterpret_cast<const char*>(read.data()), read.size());
      shard.add(from, members[next], bytes);
      index += name + "," + csv_cell(members[next].name) + "," + std::to_string(bytes.size()) + "," +
               sha256_hex(bytes) + "\n";
    }
    shard.finish();
    sums += sha256_hex_of_file(written.back()) + "  " + name + "\n";
  }
  write_file_atomically(making.path() / "index.csv", index);
  write_file_atomically(making.path() / "SHA256SUMS", sums + sha256_hex(index) + "  index.csv\n");
  making.finish();
  return {members.size(), written.size()};
}

}  // namespace rigproof
