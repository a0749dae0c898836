#include "rigproof/study/workflow/scratch_folder.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

#include "error_text.h"
#include "rigproof/core/child_process.h"
#include "temp_folder.h"

namespace rigproof {
namespace {

namespace fs = std::filesystem;

// In a temporary folder of the test's own.
class Scratch : public testing::Test {
 protected:
  Scratch() { setenv("TMPDIR", temporary_.path().c_str(), 1); }
  ~Scratch() override { before_.empty() ? unsetenv("TMPDIR") : setenv("TMPDIR", before_.c_str(), 1); }

  fs::path left_by_a_killed_owner(const std::string& purpose) const {
    ChildProcess([&] {
      const ScratchFolder scratch(purpose);
      fs::create_directories(scratch.path() / "work/left");
      return raise(SIGKILL);
    }).wait();
    for (const auto& entry : fs::directory_iterator(temporary_.path()))
      if (entry.path().filename().string().find(purpose) != std::string::npos) return entry.path();
    return {};
  }

 private:
  const std::string before_ = std::getenv("TMPDIR") != nullptr ? std::getenv("TMPDIR") : "";
  const TempFolder temporary_;
};

TEST_F(Scratch, IsGoneWithItsOwner) {
  fs::path path;
  {
    const ScratchFolder scratch("a");
    path = scratch.path();
    EXPECT_TRUE(fs::is_directory(path));
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST_F(Scratch, WhereNoneCanBeMadeTheReasonIsSaid) {
  const std::string gone = (fs::temp_directory_path() / "gone").string();
  setenv("TMPDIR", gone.c_str(), 1);
  EXPECT_EQ(error_text([] { const ScratchFolder scratch("a"); }),
            gone + ": cannot use it as the folder of temporary files (TMPDIR): No such file or directory");
}

TEST_F(Scratch, OfAKilledOwnerIsRemovedNextTime) {
  const fs::path left = left_by_a_killed_owner("b");
  ASSERT_TRUE(fs::is_directory(left / "work/left"));
  const ScratchFolder other("c");
  EXPECT_TRUE(fs::exists(left)) << "another purpose is another's to remove";
  const ScratchFolder next("b");
  EXPECT_FALSE(fs::exists(left));
}

TEST_F(Scratch, OfALivingOwnerAndWhatOnlyLooksLikeOneStay) {
  const ScratchFolder living("d");
  const fs::path theirs = living.path().parent_path() / "rigproof-d-backup";
  fs::create_directory(theirs);
  const ScratchFolder next("d");
  EXPECT_TRUE(fs::exists(living.path()));
  EXPECT_TRUE(fs::exists(theirs));
}

}  // namespace
}  // namespace rigproof
