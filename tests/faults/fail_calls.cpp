// fail_calls.cpp: preloaded before a command, this library makes one of its calls of the system
// fail, or stop. Only calls that change files below a folder count.
//   VOG_FAULT_FOLDER  text that the paths of those files contain
//   VOG_FAULT_CALL    number of the call, from 1; 0: none, their number is written to VOG_FAULT_MARK
//   VOG_FAULT_ERROR   its errno; 0: it creates the file VOG_FAULT_MARK and waits for a signal
//   VOG_FAULT_MARK    file that is created when the call comes, to which the call's name is written
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

std::atomic<int> calls{0};

template <class Function>
Function* next(Function*, const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}
#define NEXT(name) next(&::name, #name)

bool counts(const char* path) {
    const char* folder = std::getenv("VOG_FAULT_FOLDER");
    return folder && path && std::strstr(path, folder);
}
bool counts(int file) {
    char link[32], path[4096];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const ssize_t size = ::readlink(link, path, sizeof path - 1);
    path[size < 0 ? 0 : size] = 0;
    return counts(path);
}

/// By the numbers of the calls: they must not count themselves.
void write_mark(const char* text) {
    const int mark = static_cast<int>(::syscall(SYS_openat, AT_FDCWD, std::getenv("VOG_FAULT_MARK"),
                                                O_WRONLY | O_CREAT | O_TRUNC, 0666));
    (void)::syscall(SYS_write, mark, text, std::strlen(text));
    (void)::syscall(SYS_close, mark);
}

/// Whether this call is the one to fail: errno is set.
bool fails(const char* name) {
    const char* call = std::getenv("VOG_FAULT_CALL");
    if (!call || ++calls != std::atoi(call)) return false;
    write_mark(name);
    const int error = std::atoi(std::getenv("VOG_FAULT_ERROR"));
    while (error == 0) ::pause();
    errno = error;
    return true;
}

struct Count {
    ~Count() {
        const char* call = std::getenv("VOG_FAULT_CALL");
        if (!call || std::atoi(call) != 0) return;
        char text[16];
        std::snprintf(text, sizeof text, "%d", calls.load());
        write_mark(text);
    }
} at_end;

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
    va_list more;
    va_start(more, flags);
    const mode_t mode = va_arg(more, mode_t);
    va_end(more);
    if ((flags & O_ACCMODE) != O_RDONLY && counts(path) && fails("open")) return -1;
    return NEXT(open)(path, flags, mode);
}
FILE* fopen64(const char* path, const char* mode) {
    if (mode[0] != 'r' && counts(path) && fails("fopen")) return nullptr;
    return NEXT(fopen64)(path, mode);
}
FILE* fopen(const char* path, const char* mode) {
    if (mode[0] != 'r' && counts(path) && fails("fopen")) return nullptr;
    return NEXT(fopen)(path, mode);
}
ssize_t write(int file, const void* bytes, size_t count) {
    if (counts(file) && fails("write")) return -1;
    return NEXT(write)(file, bytes, count);
}
ssize_t writev(int file, const struct iovec* parts, int count) {
    if (counts(file) && fails("writev")) return -1;
    return NEXT(writev)(file, parts, count);
}
off64_t lseek64(int file, off64_t offset, int from) noexcept {
    if (counts(file) && fails("lseek")) return -1;
    return NEXT(lseek64)(file, offset, from);
}
int fclose(FILE* file) {
    const bool failed = counts(::fileno(file)) && fails("fclose");
    const int error = errno;
    const int result = NEXT(fclose)(file);
    errno = error;
    return failed ? EOF : result;
}
int fsync(int file) {
    if (counts(file) && fails("fsync")) return -1;
    return NEXT(fsync)(file);
}
int rename(const char* from, const char* to) noexcept {
    if (counts(to) && fails("rename")) return -1;
    return NEXT(rename)(from, to);
}
int mkdir(const char* path, mode_t mode) noexcept {
    if (counts(path) && fails("mkdir")) return -1;
    return NEXT(mkdir)(path, mode);
}
int posix_fallocate64(int file, off64_t offset, off64_t length) {
    return counts(file) && fails("fallocate") ? errno
                                              : NEXT(posix_fallocate64)(file, offset, length);
}
int posix_fallocate(int file, off_t offset, off_t length) {
    return counts(file) && fails("fallocate") ? errno : NEXT(posix_fallocate)(file, offset, length);
}

}  // extern "C"
