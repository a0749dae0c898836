#include "rigproof/core/files.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <thread>

#include "error_text.h"
#include "rigproof/core/growing_file.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  return names;
}

// Runs the call in a process of its own, whose limits and mounts nobody else sees; returns what it returns.
std::string in_own_process(const std::function<std::string()>& call) {
  int pipe_ends[2];
  if (pipe(pipe_ends) != 0) return "pipe failed";
  const pid_t child = fork();
  if (child == 0) {
    const std::string text = call();
    const ssize_t written = write(pipe_ends[1], text.data(), text.size());
    _exit(written == static_cast<ssize_t>(text.size()) ? 0 : 1);
  }
  close(pipe_ends[1]);
  std::string text;
  char buffer[4096];
  for (ssize_t count = 0; (count = read(pipe_ends[0], buffer, sizeof buffer)) > 0;)
    text.append(buffer, static_cast<std::size_t>(count));
  close(pipe_ends[0]);
  waitpid(child, nullptr, 0);
  return text;
}

std::string names_text(const fs::path& folder) {
  std::string text;
  for (const std::string& name : names_in(folder)) text += " " + name;
  return text;
}

TEST(Files, WriteAppearsWholeWithItsFolders) {
  const TempFolder folder;
  write_file_atomically(folder / "a/b/c.txt", "hello");
  EXPECT_EQ(folder.read("a/b/c.txt"), "hello");
  write_file_atomically(folder / "a/b/c.txt", std::vector<std::uint8_t>{0, 255, 10});
  EXPECT_EQ(folder.read("a/b/c.txt"), std::string("\0\xff\n", 3));
  EXPECT_THAT(names_in(folder / "a/b"), testing::ElementsAre("c.txt")) << "no temporary file may remain";
}

TEST(Files, ARelativeNameNeedsNoFolder) {
  const TempFolder folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  write_file_atomically("plain.txt", "x");
  fs::current_path(before);
  EXPECT_EQ(folder.read("plain.txt"), "x");
}

// As root a rename would replace the device: every other program then writes into a file.
TEST(Files, APipeIsWrittenToAndStays) {
  const TempFolder folder;
  const fs::path pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(error_text([&] { write_file_atomically(pipe, "x"); }),
            pipe.string() + ": cannot write: nobody reads this pipe");
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  fs::create_symlink("pipe", folder / "link");  // as /dev/stdout is
  write_file_atomically(pipe, "hello ");
  write_file_atomically_unsynced(folder / "link", "world");
  char read_back[32] = {};
  EXPECT_EQ(read(reader, read_back, sizeof read_back), 11);
  EXPECT_STREQ(read_back, "hello world");
  close(reader);
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(names_in(folder.path()).size(), 2U);
}

// Where the test may make one; a real device is not put at risk.
TEST(Files, ADeviceIsWrittenToAndStays) {
  const TempFolder folder;
  const fs::path device = folder / "null";
  if (mknod(device.c_str(), S_IFCHR | 0600, makedev(1, 3)) != 0) return;
  const int writable = open(device.c_str(), O_WRONLY);
  if (writable < 0) return;  // a file system that opens no devices
  close(writable);
  write_file_atomically(device, "x");
  EXPECT_TRUE(fs::is_character_file(device));
}

TEST(Files, ALinkIsRefusedAndItsTargetUntouched) {
  const TempFolder folder;
  folder.write("precious", "old");
  fs::create_symlink("precious", folder / "link");
  fs::create_symlink("gone/file", folder / "dangling");
  EXPECT_EQ(error_text([&] { write_file_atomically(folder / "link", "x"); }),
            (folder / "link").string() +
                ": cannot write: it is a link to precious, and links are not followed; name the file itself, or "
                "remove the link");
  EXPECT_THAT(error_text([&] { write_file_atomically(folder / "dangling", "x"); }), HasSubstr("a link to gone/file"));
  EXPECT_THAT(error_text([&] { GrowingFile file(folder / "link"); }), HasSubstr("a link to precious"));
  EXPECT_EQ(folder.read("precious"), "old");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(names_in(folder.path()).size(), 3U);
}

TEST(Files, ThreadsMayWriteTheSameFile) {
  const TempFolder folder;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&, i] {
      for (int j = 0; j < 20; ++j)
        write_file_atomically(folder / "shared.txt", std::string(5000, static_cast<char>('a' + i)));
    });
  for (std::thread& thread : threads) thread.join();
  const std::string text = folder.read("shared.txt");
  EXPECT_EQ(text, std::string(5000, text[0])) << "the file must be one writer's, whole";
}

TEST(Files, AFileSizeLimitLeavesTheOldFileAndNothingElse) {
  const TempFolder folder;
  folder.write("result.yaml", "old");
  const std::string text = in_own_process([&] {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit = {1000, 1000};
    setrlimit(RLIMIT_FSIZE, &limit);
    return error_text([&] { write_file_atomically(folder / "result.yaml", std::string(100000, 'x')); });
  });
  EXPECT_THAT(text, HasSubstr("result.yaml: cannot write: the file would exceed the largest size"));
  EXPECT_EQ(folder.read("result.yaml"), "old");
  EXPECT_THAT(names_in(folder.path()), testing::ElementsAre("result.yaml"));
}

// A file system of 64 KiB in a mount namespace of the test's own.
bool becomes_small_disk(const fs::path& folder) {
  const bool own = unshare(CLONE_NEWNS) == 0 || unshare(CLONE_NEWUSER | CLONE_NEWNS) == 0;
  return own && mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
         mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=64k") == 0;
}

// A real full disk. Where the machine grants no such namespace the size limit above stands for it.
TEST(Files, AFullDiskIsNamedAndLeavesNothing) {
  const TempFolder folder;
  const std::string text = in_own_process([&]() -> std::string {
    if (!becomes_small_disk(folder.path())) return "no namespace";
    const std::string error =
        error_text([&] { write_file_atomically(folder / "result.yaml", std::string(1000000, 'x')); });
    return error + "|" + names_text(folder.path());
  });
  if (text == "no namespace") return;
  EXPECT_EQ(text, (folder / "result.yaml").string() + ": cannot write: the disk is full|");
}

TEST(Files, ADiskWithoutRoomIsToldInNumbersThatSaySomething) {
  const TempFolder folder;
  require_disk_space(folder.path(), 1.0);
  EXPECT_THAT(error_text([&] { require_disk_space(folder.path(), 3e18); }),
              testing::MatchesRegex(folder.path().string() +
                                    ": the disk is nearly full: about 3000000000.0 GB are needed, .* are free"));
  const std::string text = in_own_process([&]() -> std::string {
    if (!becomes_small_disk(folder.path())) return "no namespace";
    require_disk_space(folder.path(), 90e3, 0.7);
    return error_text([&] { require_disk_space(folder.path(), 300e3, 0.7); });
  });
  if (text == "no namespace") return;
  EXPECT_EQ(text, folder.path().string() + ": the disk is nearly full: about 0.3 MB are needed, 66 kB are free");
}

TEST(Files, AFolderThatCannotBeWrittenIsNamed) {
  const TempFolder folder;
  fs::create_directory(folder / "locked");
  chmod((folder / "locked").c_str(), 0555);
  chmod(folder.path().c_str(), 0755);
  const std::string text = in_own_process([&]() -> std::string {
    // Permissions do not bind root.
    if (geteuid() == 0 && seteuid(65534) != 0) return "cannot drop privileges";
    return error_text([&] { write_file_atomically(folder / "locked/a.txt", "x"); });
  });
  EXPECT_EQ(text, (folder / "locked/a.txt").string() + ": cannot write: no permission");
}

TEST(Files, AFolderThatCannotBeCreatedIsNamed) {
  const TempFolder folder;
  folder.write("file", "x");
  EXPECT_THAT(error_text([&] { write_file_atomically(folder / "file/a.txt", "x"); }),
              HasSubstr((folder / "file").string() + ": cannot create the folder"));
  fs::create_directory(folder / "target");
  EXPECT_THAT(error_text([&] { write_file_atomically(folder / "target", "x"); }), HasSubstr("cannot write"));
  EXPECT_THAT(names_in(folder / "target"), IsEmpty());
}

TEST(Files, ReadingRefusesWhatIsNoRegularFileOrTooLarge) {
  const TempFolder folder;
  folder.write("big", std::string(1000, 'x'));
  mkfifo((folder / "pipe").c_str(), 0600);
  EXPECT_EQ(read_text_file(folder / "big", 1000).size(), 1000U);
  EXPECT_EQ(error_text([&] { read_text_file(folder / "big", 999); }),
            (folder / "big").string() + ": 1000 bytes, allowed are at most 999");
  EXPECT_THAT(error_text([&] { read_text_file(folder / "pipe"); }), HasSubstr("not a regular file"));
  EXPECT_THAT(error_text([&] { read_text_file(folder.path()); }), HasSubstr("not a regular file"));
  EXPECT_THAT(error_text([&] { read_text_file(folder / "none"); }), HasSubstr("none: cannot read: No such file"));
  EXPECT_THAT(error_text([&] { read_text_file("/dev/zero"); }), HasSubstr("not a regular file"));
}

// FIPS 180-2, appendix B, and the empty message.
TEST(Files, Sha256KnownAnswers) {
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  const TempFolder folder;
  const auto file = folder.write("million", std::string(1000000, 'a'));
  EXPECT_EQ(sha256_hex_of_file(file), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Files, PathsStayInsideTheFolder) {
  const TempFolder folder;
  folder.write("run/left/a.png", "x");
  folder.write("secret", "x");
  fs::create_symlink(folder / "secret", folder / "run/link.png");
  fs::create_directory_symlink(folder.path(), folder / "run/up");
  fs::create_symlink("left/a.png", folder / "run/inner.png");
  const fs::path run = folder / "run";
  EXPECT_EQ(path_inside(run, "left/a.png"), run / "left/a.png");
  EXPECT_EQ(path_inside(run, "left/../left/new.png"), run / "left/../left/new.png");
  EXPECT_EQ(path_inside(run, "inner.png"), run / "inner.png") << "a link that stays inside is fine";
  for (const char* bad : {"", "/etc/passwd", "../secret", "left/../../secret", "link.png", "up/secret", "..", "up"})
    EXPECT_NE(error_text([&] { path_inside(run, bad); }), "") << bad;
  EXPECT_NE(error_text([&] { path_inside(run, std::string("a\0b", 3)); }), "");
  // A sibling whose name begins like the folder's is not inside.
  folder.write("run2/a", "x");
  EXPECT_NE(error_text([&] { path_inside(run, "../run2/a"); }), "");
}

TEST(Files, PathInsideTakesRelativeFolders) {
  EXPECT_EQ(path_inside(".", "a/b"), fs::path("./a/b"));
  EXPECT_NE(error_text([] { path_inside(".", "../a"); }), "");
}

}  // namespace
}  // namespace rigproof
