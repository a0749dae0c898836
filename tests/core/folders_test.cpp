#include "rigproof/core/folders.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cerrno>

#include "error_text.h"
#include "rigproof/core/error.h"
#include "rigproof/core/folder_lock.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// As long as it lives no file can be opened.
class NoDescriptors {
 public:
  NoDescriptors() {
    getrlimit(RLIMIT_NOFILE, &before_);
    const rlimit none{0, before_.rlim_max};
    setrlimit(RLIMIT_NOFILE, &none);
  }
  ~NoDescriptors() { setrlimit(RLIMIT_NOFILE, &before_); }
  NoDescriptors(const NoDescriptors&) = delete;
  NoDescriptors& operator=(const NoDescriptors&) = delete;

 private:
  rlimit before_{};
};

ExitCode exit_code_of(const std::function<void()>& call) {
  try {
    call();
    return ExitCode::kGood;
  } catch (const Error& error) {
    return error.exit_code();
  }
}

TEST(Folders, AreListedInTheOrderOfTheirPaths) {
  const TempFolder folder;
  for (const char* name : {"b", "a/z", "a/y"}) folder.write(name, "");
  EXPECT_THAT(folder_entries(folder.path()),
              ElementsAre(fs::directory_entry(folder / "a"), fs::directory_entry(folder / "b")));
  EXPECT_EQ(folder_tree(folder.path()).size(), 4U);
}

TEST(Folders, WhatIsNoFolderHoldsNothing) {
  const TempFolder folder;
  EXPECT_THAT(folder_entries(folder / "missing"), IsEmpty());
  EXPECT_THAT(folder_tree(folder.write("file", "")), IsEmpty());
}

TEST(Folders, OneThatCannotBeReadIsNotTakenForAnEmptyOne) {
  const TempFolder folder;
  folder.write("file", "");
  const NoDescriptors none;
  EXPECT_THAT(error_text([&] { folder_entries(folder.path()); }), HasSubstr(folder.path().string()));
  EXPECT_THAT(error_text([&] { folder_tree(folder.path()); }), HasSubstr("cannot read the folder"));
  EXPECT_EQ(exit_code_of([&] { folder_entries(folder.path()); }), ExitCode::kTryAgain);
}

// Who waits for a folder to become free must not wait for a disk that stays full.
TEST(Folders, LockedByAnotherIsAnErrorOfItsOwn) {
  const TempFolder folder;
  const FolderLock lock(folder.path(), "");
  EXPECT_THROW(FolderLock(folder.path(), "in use", FolderLock::Kind::kAlone, std::chrono::milliseconds(0)),
               FolderInUse);
  const NoDescriptors none;
  try {
    const FolderLock second(folder.path(), "in use");
    FAIL() << "was locked without a descriptor";
  } catch (const FolderInUse&) {
    FAIL() << "nobody was asked";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("cannot open"));
  }
}

TEST(Folders, ErrorsOfTheMachineAreWorthAnotherTry) {
  for (const int error : {ENOSPC, EMFILE, ENOMEM, ESTALE})
    EXPECT_EQ(exit_code_of([&] { throw_system_error("file", "write", error); }), ExitCode::kTryAgain) << error;
  for (const int error : {EACCES, EIO, EROFS, ENOENT})
    EXPECT_EQ(exit_code_of([&] { throw_system_error("file", "write", error); }), ExitCode::kBadInput) << error;
}

}  // namespace
}  // namespace rigproof
