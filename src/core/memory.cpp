// memory.cpp: arrays in unnamed mapped files, and the thread that drops their pages.
#include "vog/memory.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <linux/magic.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <mutex>
#include <new>
#include <string>
#include <thread>

#include "core/paging.h"
#include "vog/error.h"

namespace vog {

namespace {

constexpr std::uint64_t kLeastLimit = 64 << 20;
constexpr std::uint64_t kShareOfFiles = 16;  // arrays of a sixteenth of the limit lie in files

/// Resident memory of the process, bytes; 0 if the system does not report it.
std::uint64_t resident_memory() {
    // Two counts of pages: address space, resident. Plain read(): called up to 20 times per ms.
    char text[128] = {};
    const int file = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    if (file < 0) return 0;
    const ssize_t got = ::read(file, text, sizeof text - 1);
    ::close(file);
    const char* resident = got > 0 ? std::strchr(text, ' ') : nullptr;
    static const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
    return resident ? std::strtoull(resident, nullptr, 10) * page : 0;
}

/// Arrays that lie in mapped files. A dropped page is read back from its file on access.
class Mappings {
  public:
    void add(void* memory, std::size_t bytes) {
        const std::lock_guard lock(mutex_);
        all_[memory] = bytes;
        bytes_ += bytes;
        peak_bytes_ = std::max(peak_bytes_, bytes_);
        any_ = true;
    }
    /// Unmaps an array; false if it is not one of these.
    bool remove(void* memory) {
        if (!any_.load(std::memory_order_acquire)) return false;
        const std::lock_guard lock(mutex_);
        const auto found = all_.find(memory);
        if (found == all_.end()) return false;
        ::munmap(memory, found->second);
        bytes_ -= found->second;
        all_.erase(found);
        return true;
    }
    void drop_pages() {
        const std::lock_guard lock(mutex_);
        for (const auto& [memory, bytes] : all_) ::madvise(memory, bytes, MADV_DONTNEED);
    }
    std::uint64_t peak_bytes() {
        const std::lock_guard lock(mutex_);
        return peak_bytes_;
    }
    void reset_peak() {
        const std::lock_guard lock(mutex_);
        peak_bytes_ = bytes_;
    }

  private:
    std::mutex mutex_;
    std::map<void*, std::size_t> all_;
    std::uint64_t bytes_ = 0, peak_bytes_ = 0;
    std::atomic<bool> any_{false};
};

Mappings& mappings() {
    static Mappings* const mappings = new Mappings;  // outlives every array
    return *mappings;
}

struct FilePolicy {
    /// Smallest array that lies in a file of `folder`, bytes; 0: no limit is set.
    std::atomic<std::uint64_t> least_bytes{0};
    std::atomic<std::uint64_t> high{0};  ///< resident bytes from which pages are dropped
    std::mutex mutex;
    std::filesystem::path folder;
};
FilePolicy& policy() {
    static FilePolicy policy;
    return policy;
}

[[noreturn]] void fail(const std::filesystem::path& folder, const std::string& what, int error) {
    throw Error(fmt::format("{}: {}: {}", folder.string(), what, std::strerror(error)));
}

/// The system's folder for temporary files.
std::filesystem::path default_scratch_folder() {
    std::error_code code;
    const std::filesystem::path folder = std::filesystem::temp_directory_path(code);
    if (!code) return folder;
    const char* named = std::getenv("TMPDIR");
    throw Error(
        fmt::format("TMPDIR={}: this folder for scratch files does not exist", named ? named : ""));
}

/// Opens a file without a name: O_TMPFILE, or a temporary file unlinked at once.
int open_nameless(const std::filesystem::path& folder) {
    int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (file < 0 && (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL)) {
        std::string pattern = (folder / "vog-XXXXXX").string();
        file = ::mkostemp(pattern.data(), O_CLOEXEC);
        if (file >= 0) ::unlink(pattern.c_str());
    }
    if (file < 0) fail(folder, "cannot make a scratch file here", errno);
    return file;
}

void* map_file(std::size_t bytes) {
    std::filesystem::path folder;
    {
        const std::lock_guard lock(policy().mutex);
        folder = policy().folder;
    }
    const int file = open_nameless(folder);
    // Blocks are reserved now: on a full disk, a later write to memory would raise SIGBUS.
    const int full = ::posix_fallocate(file, 0, static_cast<off_t>(bytes));
    void* memory = MAP_FAILED;
    if (full == 0) memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    const int error = full ? full : errno;
    ::close(file);
    if (memory == MAP_FAILED)
        fail(folder, fmt::format("cannot make a scratch file of {} bytes", bytes), error);
    // With huge pages one access maps 2 MiB, 40 MB between two checks of keep_memory. A kernel
    // without them refuses the advice and does not need it.
    (void)::madvise(memory, bytes, MADV_NOHUGEPAGE);
    mappings().add(memory, bytes);
    return memory;
}

}  // namespace

bool memory_limited() { return policy().least_bytes.load(std::memory_order_relaxed) != 0; }

void keep_memory() {
    if (!memory_limited()) return;
    using Clock = std::chrono::steady_clock;
    // Random access maps about 3 MB in this time: the system maps 64 KiB around each page.
    constexpr Clock::duration kPeriod = std::chrono::microseconds(50);
    constexpr Clock::duration kTrimPeriod = std::chrono::milliseconds(100);
    static std::atomic<Clock::rep> next{0}, next_trim{0};
    const Clock::rep now = Clock::now().time_since_epoch().count();
    Clock::rep due = next.load(std::memory_order_relaxed);
    // Only one thread of those that call checks.
    if (now < due || !next.compare_exchange_strong(due, now + kPeriod.count())) return;
    const std::uint64_t high = policy().high.load(std::memory_order_relaxed);
    if (resident_memory() < high) return;
    mappings().drop_pages();
    if (resident_memory() < high || now < next_trim.load(std::memory_order_relaxed)) return;
    // Memory outside the files exceeds the threshold: return free memory of malloc.
    ::malloc_trim(0);
    next_trim = now + kTrimPeriod.count();
}

/// Thread that calls keep_memory() every millisecond, for time spent inside other libraries.
class MemoryLimit::Pager {
  public:
    Pager() : thread_([this] { watch(); }) {}
    ~Pager() {
        {
            const std::lock_guard lock(mutex_);
            ends_ = true;
        }
        wake_.notify_one();
        thread_.join();
    }

  private:
    void watch() {
        std::unique_lock lock(mutex_);
        while (!wake_.wait_for(lock, std::chrono::milliseconds(1), [this] { return ends_; }))
            keep_memory();
    }

    std::mutex mutex_;
    std::condition_variable wake_;
    bool ends_ = false;
    std::thread thread_;
};

MemoryLimit::MemoryLimit(std::uint64_t bytes, const std::filesystem::path& folder) {
    if (bytes < kLeastLimit)
        throw Error(
            fmt::format("memory limit of {} bytes, expected at least {}", bytes, kLeastLimit));
    const auto where = folder.empty() ? default_scratch_folder() : folder;
    ::close(open_nameless(where));
    struct statfs kind {};
    if (::statfs(where.c_str(), &kind) == 0 && kind.f_type == TMPFS_MAGIC)
        throw Error(fmt::format("{}: lies in memory (tmpfs), expected a scratch folder on a disk",
                                where.string()));
    FilePolicy& files = policy();
    const std::lock_guard lock(files.mutex);
    if (files.least_bytes != 0)
        throw Error("a memory limit is already set, expected one at a time");
    mappings().reset_peak();
    files.folder = where;
    files.high = bytes / 8 * 5;  // other threads map pages while these are dropped
    files.least_bytes = bytes / kShareOfFiles;
    pager_ = std::make_unique<Pager>();
}

MemoryLimit::~MemoryLimit() { policy().least_bytes = 0; }

std::uint64_t MemoryLimit::scratch_bytes() const { return mappings().peak_bytes(); }

std::uint64_t peak_memory() {
    // Not getrusage: its peak includes that of the parent before exec.
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) return std::stoull(line.substr(6)) * 1024;
    return 0;
}

void* BigMemory::allocate(std::size_t bytes, std::size_t alignment) {
    const std::uint64_t least = policy().least_bytes.load(std::memory_order_relaxed);
    if (least != 0 && bytes >= least) return map_file(bytes);
    if (alignment > __STDCPP_DEFAULT_NEW_ALIGNMENT__)
        return ::operator new(bytes, std::align_val_t(alignment));
    return ::operator new(bytes);
}

void BigMemory::free(void* memory, std::size_t alignment) noexcept {
    if (mappings().remove(memory)) return;
    if (alignment > __STDCPP_DEFAULT_NEW_ALIGNMENT__)
        ::operator delete(memory, std::align_val_t(alignment));
    else
        ::operator delete(memory);
}

}  // namespace vog
