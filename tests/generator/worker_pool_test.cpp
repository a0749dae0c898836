#include "worker_pool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <set>

#include "rigproof/core/error.h"

namespace rigproof {
namespace {

using testing::HasSubstr;

constexpr double kPatienceS = 60.0;

WorkerPool::Prepare squares() {
  return [](std::string* greeting) {
    *greeting = "hello";
    return [](std::uint32_t job) { return std::to_string(job * job); };
  };
}

WorkerPool::Prepare hanging() {
  return [](std::string*) {
    return [](std::uint32_t) {
      ::pause();
      return std::string();
    };
  };
}

// The first event that is neither a greeting nor a result.
WorkerEvent first_trouble(WorkerPool* pool) {
  for (;;) {
    for (const WorkerEvent& event : pool->wait(1000)) {
      if (event.kind == WorkerEvent::Kind::kDied || event.kind == WorkerEvent::Kind::kFailed) return event;
    }
  }
}

TEST(WorkerPool, EveryJobIsDoneOnce) {
  WorkerPool pool(3, squares(), kPatienceS);
  std::set<std::uint32_t> done;
  std::uint32_t next = 0;
  int greetings = 0;
  while (done.size() < 200) {
    while (next < 200 && pool.wants_job()) pool.submit(next++);
    for (const WorkerEvent& event : pool.wait(1000)) {
      if (event.kind == WorkerEvent::Kind::kReady) {
        ++greetings;
        EXPECT_EQ(event.text, "hello");
        continue;
      }
      ASSERT_EQ(event.kind, WorkerEvent::Kind::kDone);
      EXPECT_EQ(event.text, std::to_string(event.job * event.job));
      EXPECT_TRUE(done.insert(event.job).second);
    }
  }
  EXPECT_EQ(greetings, 3);
  EXPECT_EQ(pool.jobs_in_flight(), 0U);
}

TEST(WorkerPool, CrashNamesTheSignalAndTheJob) {
  WorkerPool pool(
      2,
      [](std::string*) {
        return [](std::uint32_t) -> std::string {
          ::raise(SIGKILL);
          return "";
        };
      },
      kPatienceS);
  pool.submit(17);
  const WorkerEvent event = first_trouble(&pool);
  EXPECT_EQ(event.kind, WorkerEvent::Kind::kDied);
  EXPECT_EQ(event.job, 17U);
  EXPECT_THAT(event.text, HasSubstr("signal 9"));
}

TEST(WorkerPool, ExceptionArrivesAsItsMessage) {
  WorkerPool pool(
      1, [](std::string*) -> WorkerPool::Handler { throw Error("no EGL: install libegl1"); }, kPatienceS);
  pool.submit(3);
  const WorkerEvent event = first_trouble(&pool);
  EXPECT_EQ(event.kind, WorkerEvent::Kind::kFailed);
  EXPECT_EQ(event.text, "no EGL: install libegl1");
}

// With jobs unread the kernel reports a broken connection before the message.
TEST(WorkerPool, FailureToPrepareIsToldThoughJobsWait) {
  std::array<int, 2> submitted{}, alive{};
  ASSERT_EQ(::pipe(submitted.data()), 0);
  ASSERT_EQ(::pipe(alive.data()), 0);
  char byte = 0;
  WorkerPool pool(
      1,
      [&](std::string*) -> WorkerPool::Handler {
        EXPECT_EQ(::read(submitted[0], &byte, 1), 1);
        throw Error("no EGL");
      },
      kPatienceS);
  ::close(alive[1]);
  pool.submit(1);
  pool.submit(2);
  ASSERT_EQ(::write(submitted[1], &byte, 1), 1);
  ASSERT_EQ(::read(alive[0], &byte, 1), 0);  // the process, which held the other end, is gone
  const WorkerEvent event = first_trouble(&pool);
  EXPECT_EQ(event.kind, WorkerEvent::Kind::kFailed);
  EXPECT_EQ(event.text, "no EGL");
  for (const int end : {submitted[0], submitted[1], alive[0]}) ::close(end);
}

TEST(WorkerPool, EndsAfterTheJobInWork) {
  std::array<int, 2> begun{}, finished{};
  ASSERT_EQ(::pipe(begun.data()), 0);
  ASSERT_EQ(::pipe(finished.data()), 0);
  char byte = 0;
  {
    WorkerPool pool(
        1,
        [&](std::string*) {
          return [&](std::uint32_t job) {
            const char name = static_cast<char>('a' + job);
            if (::write(begun[1], &name, 1) != 1) return std::string("no pipe");
            ::usleep(300'000);  // as one that writes a file
            if (::write(finished[1], &name, 1) != 1) return std::string("no pipe");
            return std::string();
          };
        },
        kPatienceS);
    pool.submit(0);
    pool.submit(1);
    ASSERT_EQ(::read(begun[0], &byte, 1), 1);
  }
  ::close(finished[1]);
  ASSERT_EQ(::read(finished[0], &byte, 1), 1) << "the job in work was cut off";
  EXPECT_EQ(byte, 'a');
  EXPECT_EQ(::read(finished[0], &byte, 1), 0) << "the next job was begun";
  for (const int end : {begun[0], begun[1], finished[0]}) ::close(end);
}

TEST(WorkerPool, EndsOneThatHangs) {
  const auto begun = std::chrono::steady_clock::now();
  {
    WorkerPool pool(1, hanging(), 0.2);
    pool.submit(0);
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(60));
}

TEST(WorkerPool, ProcessThatHangsCountsAsDead) {
  WorkerPool pool(1, hanging(), 0.2);
  pool.submit(0);
  EXPECT_THAT(first_trouble(&pool).text, HasSubstr("did not answer"));
}

}  // namespace
}  // namespace rigproof
