// An allocator that is loaded before all libraries, as jemalloc would be.
#include <cstddef>

extern "C" {
void* __libc_malloc(std::size_t size);
void __libc_free(void* block);
__attribute__((visibility("default"))) void* malloc(std::size_t size) noexcept { return __libc_malloc(size); }
__attribute__((visibility("default"))) void free(void* block) noexcept { __libc_free(block); }
}
