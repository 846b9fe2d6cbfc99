#include "tests/fuzz/allocation_meter.hpp"

#include <cstdlib>
#include <new>

namespace {

thread_local size_t given = 0;

}  // namespace

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define TROCHOID_SANITIZER_COUNTS 1
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define TROCHOID_SANITIZER_COUNTS 1
#endif

#ifdef TROCHOID_SANITIZER_COUNTS

// These sanitizers have their own operator new, and tell of each allocation.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*allocated)(const volatile void*, size_t),
                                                         void (*freed)(const volatile void*));

namespace {

[[maybe_unused]] const int installed = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, size_t bytes) { given += bytes; }, [](const volatile void*) {});

}  // namespace

#else

namespace {

void* counted(size_t bytes) noexcept {
    given += bytes;
    return std::malloc(bytes == 0 ? 1 : bytes);
}

void* counted_or_thrown(size_t bytes) {
    void* memory = counted(bytes);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

}  // namespace

void* operator new(size_t bytes) { return counted_or_thrown(bytes); }
void* operator new[](size_t bytes) { return counted_or_thrown(bytes); }
void* operator new(size_t bytes, const std::nothrow_t&) noexcept { return counted(bytes); }
void* operator new[](size_t bytes, const std::nothrow_t&) noexcept { return counted(bytes); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, size_t) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { std::free(memory); }

#endif

namespace trochoid {

AllocationMeter::AllocationMeter() : before_(given) {}

size_t AllocationMeter::bytes() const { return given - before_; }

}  // namespace trochoid
