// processor.cpp: refusal, at start, of processors that lack instructions the program was compiled for.
// The check runs before the constructors of any shared library (.preinit_array) and is compiled for the oldest
// processors. Loops with Highway, Embree and TBB choose their instructions when they run and need no check.
#if defined(__x86_64__) && defined(__GNUC__) && defined(__linux__)
#include <cpuid.h>
#include <unistd.h>

namespace {

/// A set of instructions: bit of a register that CPUID returns.
struct Instructions {
    const char* name;
    bool compiled;            ///< whether the compiler uses it everywhere (-march)
    unsigned leaf, reg, bit;  ///< reg: 0 eax, 1 ebx, 2 ecx, 3 edx
};

#ifdef __SSE3__
constexpr bool kSse3 = true;
#else
constexpr bool kSse3 = false;
#endif
#ifdef __SSSE3__
constexpr bool kSsse3 = true;
#else
constexpr bool kSsse3 = false;
#endif
#ifdef __SSE4_1__
constexpr bool kSse41 = true;
#else
constexpr bool kSse41 = false;
#endif
#ifdef __SSE4_2__
constexpr bool kSse42 = true;
#else
constexpr bool kSse42 = false;
#endif
#ifdef __POPCNT__
constexpr bool kPopcnt = true;
#else
constexpr bool kPopcnt = false;
#endif
#ifdef __AVX__
constexpr bool kAvx = true;
#else
constexpr bool kAvx = false;
#endif
#ifdef __FMA__
constexpr bool kFma = true;
#else
constexpr bool kFma = false;
#endif
#ifdef __AVX2__
constexpr bool kAvx2 = true;
#else
constexpr bool kAvx2 = false;
#endif
#ifdef __AVX512F__
constexpr bool kAvx512 = true;
#else
constexpr bool kAvx512 = false;
#endif

constexpr Instructions kSets[] = {
    {"SSE3", kSse3, 1, 2, 0},     {"SSSE3", kSsse3, 1, 2, 9},    {"SSE4.1", kSse41, 1, 2, 19},
    {"SSE4.2", kSse42, 1, 2, 20}, {"POPCNT", kPopcnt, 1, 2, 23}, {"AVX", kAvx, 1, 2, 28},
    {"FMA", kFma, 1, 2, 12},      {"AVX2", kAvx2, 7, 1, 5},      {"AVX-512F", kAvx512, 7, 1, 16}};

/// Text to standard error by the system call alone: the C library is not initialised yet.
__attribute__((target("arch=x86-64"))) void say(const char* text) {
    unsigned length = 0;
    while (text[length]) ++length;
    long result;
    asm volatile("syscall"
                 : "=a"(result)
                 : "0"(1L), "D"(2L), "S"(text), "d"(static_cast<long>(length))
                 : "rcx", "r11", "memory");
}

__attribute__((target("arch=x86-64"))) void check_processor(int, char**, char**) {
    for (const Instructions& set : kSets) {
        if (!set.compiled) continue;
        unsigned registers[4] = {};
        const bool known = __get_cpuid_max(0, nullptr) >= set.leaf &&
                           __get_cpuid_count(set.leaf, 0, &registers[0], &registers[1],
                                             &registers[2], &registers[3]) != 0;
        if (known && (registers[set.reg] >> set.bit & 1u)) continue;
        say("vog: this processor has no ");
        say(set.name);
        say(", which this program was compiled for; build without -march, or use another "
            "machine\n");
        asm volatile("syscall" : : "a"(231L), "D"(1L) : "rcx", "r11", "memory");  // exit_group(1)
    }
}

/// Entry that the dynamic loader calls first.
__attribute__((section(".preinit_array"),
               used)) void (*vog_check_processor)(int, char**, char**) = check_processor;

}  // namespace
#endif
