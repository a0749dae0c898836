#include "worker_pool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

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
  WorkerPool pool(
      1,
      [](std::string*) -> WorkerPool::Handler {
        ::usleep(20000);
        throw Error("no EGL");
      },
      kPatienceS);
  pool.submit(1);
  pool.submit(2);
  ::usleep(100000);
  const WorkerEvent event = first_trouble(&pool);
  EXPECT_EQ(event.kind, WorkerEvent::Kind::kFailed);
  EXPECT_EQ(event.text, "no EGL");
}

TEST(WorkerPool, ProcessThatHangsCountsAsDead) {
  WorkerPool pool(
      1,
      [](std::string*) {
        return [](std::uint32_t) {
          ::pause();
          return std::string();
        };
      },
      0.2);
  pool.submit(0);
  EXPECT_THAT(first_trouble(&pool).text, HasSubstr("did not answer"));
}

}  // namespace
}  // namespace rigproof
