// Preloaded into a program (LD_PRELOAD), lets one call to the system fail, once, and counts them all:
//   FAILING_CALLS=FILE         where counts are kept, shared by all processes that come of the program
//   FAILING_CALLS_KINDS=..     which calls count, separated by commas: the names in kKinds; default all
//   FAILING_CALLS_AT=N         the N-th call that counts fails, from 1; 0 or absent: none does
//   FAILING_CALLS_ERRNO=E      with which error, as a number; default that of its kind
// FILE is a struct Shared. Opening for reading, and what the C library does inside of itself, does not count; neither
// do pipes and terminals.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/sendfile.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

enum Kind { kOpen, kWrite, kSync, kRename, kMkdir, kClose, kTruncate, kCopy, kMmap, kFork, kKinds };

static const char* const kNames[kKinds] = {"open",  "write",    "sync", "rename", "mkdir",
                                           "close", "truncate", "copy", "mmap",   "fork"};
static const int kErrors[kKinds] = {EMFILE, ENOSPC, EIO, ENOSPC, ENOSPC, EIO, ENOSPC, ENOSPC, ENOMEM, EAGAIN};

enum { kDescriptors = 4096, kPath = 512 };

struct Shared {
  atomic_long total;
  atomic_long of_kind[kKinds];
  atomic_int failed_kind;  // 0 = none failed, else kind + 1
  char failed_on[kPath];   // the path, where there is one
};

static struct Shared* shared = NULL;
static int counts_kind[kKinds];
static long fail_at = 0;
static int forced_error = 0;
static char* path_of[kDescriptors];  // of descriptors that were opened for writing

static void* next(const char* name) { return dlsym(RTLD_NEXT, name); }

static void choose_kinds(const char* list) {
  for (int kind = 0; kind < kKinds; ++kind) {
    const char* found = list != NULL ? strstr(list, kNames[kind]) : NULL;
    counts_kind[kind] = list == NULL || found != NULL;
  }
}

__attribute__((constructor)) static void begin(void) {
  const char* file = getenv("FAILING_CALLS");
  if (file == NULL) return;
  choose_kinds(getenv("FAILING_CALLS_KINDS"));
  const char* at = getenv("FAILING_CALLS_AT");
  fail_at = at != NULL ? atol(at) : 0;
  const char* error = getenv("FAILING_CALLS_ERRNO");
  forced_error = error != NULL ? atoi(error) : 0;
  const int descriptor = (int)syscall(SYS_openat, AT_FDCWD, file, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor < 0 || syscall(SYS_ftruncate, descriptor, sizeof(struct Shared)) != 0) _exit(125);
  const long address =
      syscall(SYS_mmap, NULL, sizeof(struct Shared), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  syscall(SYS_close, descriptor);
  if (address == -1) _exit(125);
  shared = (struct Shared*)address;
}

// @return whether this call is the one to fail; errno is set then
static int fails(enum Kind kind, const char* path) {
  if (shared == NULL || !counts_kind[kind]) return 0;
  atomic_fetch_add(&shared->of_kind[kind], 1);
  if (atomic_fetch_add(&shared->total, 1) + 1 != fail_at) return 0;
  atomic_store(&shared->failed_kind, (int)kind + 1);
  if (path != NULL) strncpy(shared->failed_on, path, kPath - 1);
  errno = forced_error != 0 ? forced_error : kErrors[kind];
  return 1;
}

static const char* known_path(int descriptor) {
  return descriptor >= 0 && descriptor < kDescriptors ? path_of[descriptor] : NULL;
}

// A descriptor that is no file of ours: a pipe to a terminal, or what a library keeps for itself.
static int is_ours(int descriptor) { return known_path(descriptor) != NULL; }

static int remember(int descriptor, const char* path, int flags) {
  if (descriptor >= 0 && descriptor < kDescriptors) {
    free(path_of[descriptor]);
    path_of[descriptor] = (flags & (O_WRONLY | O_RDWR | O_DIRECTORY)) != 0 ? strdup(path) : NULL;
  }
  return descriptor;
}

// Devices are no files: what is written to them is not lost with the disk.
static int counts_open(const char* path, int flags) {
  return strncmp(path, "/dev/", 5) != 0 && strncmp(path, "/proc/", 6) != 0 &&
         (flags & (O_WRONLY | O_RDWR | O_CREAT | O_DIRECTORY)) != 0;
}

static int open_at(int folder, const char* path, int flags, mode_t mode) {
  const int counts = counts_open(path, flags);
  const int is_whole = folder == AT_FDCWD || path[0] == '/';
  if (counts && fails(kOpen, is_whole ? path : NULL)) return -1;
  const int descriptor = (int)syscall(SYS_openat, folder, path, flags, mode);
  return counts ? remember(descriptor, path, flags) : remember(descriptor, path, 0);
}

#define MODE_OF_ARGUMENTS(last)               \
  mode_t mode = 0;                            \
  if ((flags & (O_CREAT | O_TMPFILE)) != 0) { \
    va_list arguments;                        \
    va_start(arguments, last);                \
    mode = va_arg(arguments, mode_t);         \
    va_end(arguments);                        \
  }

int open(const char* path, int flags, ...) {
  MODE_OF_ARGUMENTS(flags)
  return open_at(AT_FDCWD, path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  MODE_OF_ARGUMENTS(flags)
  return open_at(AT_FDCWD, path, flags, mode);
}

int openat(int folder, const char* path, int flags, ...) {
  MODE_OF_ARGUMENTS(flags)
  return open_at(folder, path, flags, mode);
}

int creat(const char* path, mode_t mode) { return open_at(AT_FDCWD, path, O_CREAT | O_WRONLY | O_TRUNC, mode); }

static FILE* open_stream(const char* name, const char* path, const char* mode) {
  const int writes = strpbrk(mode, "wa+") != NULL;
  const int counts = writes && counts_open(path, O_WRONLY);
  if (counts && fails(kOpen, path)) return NULL;
  FILE* (*real)(const char*, const char*) = (FILE * (*)(const char*, const char*)) next(name);
  FILE* stream = real(path, mode);
  if (stream != NULL) remember(fileno(stream), path, counts ? O_WRONLY : 0);
  return stream;
}

FILE* fopen(const char* path, const char* mode) { return open_stream("fopen", path, mode); }
FILE* fopen64(const char* path, const char* mode) { return open_stream("fopen64", path, mode); }

ssize_t write(int descriptor, const void* data, size_t size) {
  if (is_ours(descriptor) && fails(kWrite, known_path(descriptor))) return -1;
  return syscall(SYS_write, descriptor, data, size);
}

ssize_t writev(int descriptor, const struct iovec* pieces, int count) {
  if (is_ours(descriptor) && fails(kWrite, known_path(descriptor))) return -1;
  return syscall(SYS_writev, descriptor, pieces, count);
}

ssize_t pwrite(int descriptor, const void* data, size_t size, off_t offset) {
  if (is_ours(descriptor) && fails(kWrite, known_path(descriptor))) return -1;
  return syscall(SYS_pwrite64, descriptor, data, size, offset);
}

ssize_t pwrite64(int descriptor, const void* data, size_t size, off64_t offset) {
  return pwrite(descriptor, data, size, offset);
}

size_t fwrite(const void* data, size_t size, size_t count, FILE* stream) {
  if (is_ours(fileno(stream)) && fails(kWrite, known_path(fileno(stream)))) return 0;
  size_t (*real)(const void*, size_t, size_t, FILE*) = (size_t(*)(const void*, size_t, size_t, FILE*))next("fwrite");
  return real(data, size, count, stream);
}

int fsync(int descriptor) { return fails(kSync, known_path(descriptor)) ? -1 : (int)syscall(SYS_fsync, descriptor); }

int fdatasync(int descriptor) {
  return fails(kSync, known_path(descriptor)) ? -1 : (int)syscall(SYS_fdatasync, descriptor);
}

int rename(const char* from, const char* to) {
  return fails(kRename, to) ? -1 : (int)syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0);
}

int renameat(int from_folder, const char* from, int to_folder, const char* to) {
  return fails(kRename, to) ? -1 : (int)syscall(SYS_renameat2, from_folder, from, to_folder, to, 0);
}

int link(const char* from, const char* to) {
  return fails(kRename, to) ? -1 : (int)syscall(SYS_linkat, AT_FDCWD, from, AT_FDCWD, to, 0);
}

int mkdir(const char* path, mode_t mode) {
  return fails(kMkdir, path) ? -1 : (int)syscall(SYS_mkdirat, AT_FDCWD, path, mode);
}

char* mkdtemp(char* template) {
  if (fails(kMkdir, template)) return NULL;
  char* (*real)(char*) = (char* (*)(char*))next("mkdtemp");
  return real(template);
}

// Closes it all the same, as the kernel does.
int close(int descriptor) {
  const int fail = is_ours(descriptor) && fails(kClose, known_path(descriptor));
  const int error = errno;
  if (is_ours(descriptor)) {
    free(path_of[descriptor]);
    path_of[descriptor] = NULL;
  }
  const int result = (int)syscall(SYS_close, descriptor);
  if (!fail) return result;
  errno = error;
  return -1;
}

int ftruncate(int descriptor, off_t size) {
  return fails(kTruncate, known_path(descriptor)) ? -1 : (int)syscall(SYS_ftruncate, descriptor, size);
}

int ftruncate64(int descriptor, off64_t size) { return ftruncate(descriptor, size); }

ssize_t copy_file_range(int from, off64_t* from_offset, int to, off64_t* to_offset, size_t size, unsigned flags) {
  if (fails(kCopy, known_path(to))) return -1;
  return syscall(SYS_copy_file_range, from, from_offset, to, to_offset, size, flags);
}

ssize_t sendfile(int to, int from, off_t* offset, size_t size) {
  return fails(kCopy, known_path(to)) ? -1 : syscall(SYS_sendfile, to, from, offset, size);
}

ssize_t sendfile64(int to, int from, off64_t* offset, size_t size) { return sendfile(to, from, offset, size); }

// Of files: what maps memory alone is the allocators' and the renderer's.
void* mmap(void* address, size_t size, int protection, int flags, int descriptor, off_t offset) {
  if (descriptor >= 0 && fails(kMmap, known_path(descriptor))) return MAP_FAILED;
  return (void*)syscall(SYS_mmap, address, size, protection, flags, descriptor, offset);
}

void* mmap64(void* address, size_t size, int protection, int flags, int descriptor, off64_t offset) {
  return mmap(address, size, protection, flags, descriptor, offset);
}

pid_t fork(void) {
  if (fails(kFork, NULL)) return -1;
  pid_t (*real)(void) = (pid_t(*)(void))next("fork");
  return real();
}
