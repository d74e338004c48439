// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <vector>

namespace vadose {

/// Allocator of storage that starts on a cache line, so that batches and records load aligned.
template <class T>
struct CacheLineAllocator {
  using value_type = T;  ///< what is allocated
  CacheLineAllocator() = default;
  /// Of another type: they are all alike.
  template <class U>
  CacheLineAllocator(const CacheLineAllocator<U>&) noexcept {}  // NOLINT: converting by design
  /// Storage of n objects.
  T* allocate(std::size_t n) {
    return static_cast<T*>(::operator new (n * sizeof(T), std::align_val_t{64}));
  }
  /// Gives it back.
  void deallocate(T* p, std::size_t) noexcept { ::operator delete (p, std::align_val_t{64}); }
  /// They are all alike.
  friend bool operator==(const CacheLineAllocator&, const CacheLineAllocator&) { return true; }
};

/// std::vector whose storage starts on a cache line.
template <class T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

/// Eight numbers of one node or cell in one cache line.
struct alignas(64) Record {
  double value[8] = {};  ///< the numbers
  double& operator[](int i) noexcept { return value[i]; }
  double operator[](int i) const noexcept { return value[i]; }
};

}  // namespace vadose
